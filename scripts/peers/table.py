"""The measured JSON as tables of text."""


def number(value, form="{:.3g}"):
    return "-" if value is None else form.format(value)


def aligned(lines):
    widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)


def integrand_table(document, integrand):
    lines = [["", "precision", "points/s", "seconds per N", "error at N", "rate",
              *(f"to {t:.0e}" for t in document["tolerances"])]]
    found = [(row, result) for row in document["rows"] for result in row["problems"]
             if result["integrand"] == integrand]
    for row, result in sorted(found, key=lambda pair: pair[1]["seconds_per_n"]["min"]):
        to = [number(t["seconds"], "{:.2e}") + ("*" if t["extrapolated"] else "") for t in result["time_to"]]
        lines.append([row["name"], row["precision"], number(result["points_per_s"], "{:.3e}"),
                      number(result["seconds_per_n"]["min"], "{:.2e}"), number(result["error"], "{:.1e}"),
                      number(result["rate"], "{:.2f}"), *to])
    return aligned(lines)


def headline_table(headlines):
    lines = [["", "integrand", "subject", "peer", "ratio", "required", ""]]
    for row in headlines:
        verdict = "" if "met" not in row else "met" if row["met"] else "MISSED"
        lines.append([row["what"], row["integrand"], row["subject"], row["peer"], number(row["ratio"], "{:.2f}"),
                      number(row.get("required"), "{:g}"), verdict])
    return aligned(lines)


def table(document):
    """All tables; `document` is the whole JSON."""
    c = document["context"]
    parts = [f"{c['host']['processor']}, {c['host']['cores']} cores; N = {c['n']} points, {c['replicates']} replicates, "
             f"d = {c['dimension']}, at most {c['rounds']} rounds in alternation, minima. {c['note']}".strip()]
    for integrand in c["integrands"]:
        parts.append(f"{integrand}: seconds of one estimate; * extrapolated\n{integrand_table(document, integrand)}")
    missing = [[row["name"], row["status"], row["reason"]] for row in document["rows"] if row["status"] != "ok"]
    if missing:
        parts.append(aligned([["not measured", "", "reason"], *missing]))
    if document["headlines"]:
        parts.append(headline_table(document["headlines"]))
    return "\n\n".join(parts)
