"""From measured times and errors to time per tolerance, ratios and headlines."""
import math

TOLERANCES = [10.0 ** -k for k in range(3, 9)]


def line(points):
    """Least squares of y on x: (intercept, slope)."""
    mean_x = sum(x for x, _ in points) / len(points)
    mean_y = sum(y for _, y in points) / len(points)
    spread = sum((x - mean_x) ** 2 for x, _ in points)
    slope = sum((x - mean_x) * (y - mean_y) for x, y in points) / spread
    return mean_y - slope * mean_x, slope


def seconds_at(curve, n):
    """Seconds of N points: interpolated in logarithms where measured, proportional to N beyond, those of the
    smallest measured N below."""
    if n <= curve[0]["n"]:
        return curve[0]["seconds"]
    for low, high in zip(curve, curve[1:]):
        if n <= high["n"]:
            share = math.log(n / low["n"]) / math.log(high["n"] / low["n"])
            return math.exp((1 - share) * math.log(low["seconds"]) + share * math.log(high["seconds"]))
    return curve[-1]["seconds"] * n / curve[-1]["n"]


def times_to(curve):
    """N and seconds to each tolerance from the line fitted to log error against log N.

    Extrapolated where that N is not among those measured; null where the error does not fall."""
    fitted = [(math.log2(p["n"]), math.log2(p["error"])) for p in curve if p["error"] > 0]
    answers = []
    intercept, slope = line(fitted) if len(fitted) > 2 else (0, 0)
    for tolerance in TOLERANCES:
        answer = {"tolerance": tolerance, "n": None, "seconds": None, "extrapolated": False}
        exponent = (math.log2(tolerance) - intercept) / slope if slope < -0.1 else math.inf
        if exponent < 80:
            n = max(1.0, 2 ** exponent)
            answer.update(n=n, seconds=seconds_at(curve, n),
                          extrapolated=not curve[0]["n"] <= n <= curve[-1]["n"])
        answers.append(answer)
    return {"rate": slope if slope else None, "time_to": answers}


def measured(rows, problem):
    """Pairs of row and its result for this problem, of rows that have one."""
    for row in rows:
        for result in row["problems"]:
            if result["integrand"] == problem:
                yield row, result


def headline(what, integrand, n, subject, peer, required):
    """subject and peer: (name, seconds per N). Without `required` the row asks for nothing."""
    ratio = peer[1] / subject[1]
    row = {"what": what, "integrand": integrand, "n": n, "subject": subject[0], "peer": peer[0], "ratio": ratio}
    if required is not None:
        row.update(required=required, met=ratio >= required)
    return row


def fastest(candidates):
    best = min(candidates, key=lambda pair: pair[1]["seconds_per_n"]["min"], default=None)
    return None if best is None else (best[0]["name"], best[1]["seconds_per_n"]["min"])


def throughput_headlines(rows, integrand, subjects):
    """Each subject against the fastest peer among the kinds of points that its entry names: in fp32 of any
    precision, in fp64 of the same."""
    results = list(measured(rows, integrand))
    answers = []
    for entry in subjects:
        own = [(r, x) for r, x in results if r["name"] == entry["name"]]
        peer = fastest([(r, x) for r, x in results if r["kind"] == "peer" and r["points"] in entry["against"] and
                        entry["precision"] in ("fp32", r["precision"])])
        if own and peer:
            result = own[0][1]
            answers.append(headline("points integrated per second, against the fastest peer", integrand, result["n"],
                                    (entry["name"], result["seconds_per_n"]["min"]), peer, entry.get("required")))
    return answers
