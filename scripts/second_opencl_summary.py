#!/usr/bin/env python3
"""What a device did with the tests and the stability suite, as one JSON: scripts/second_opencl.sh calls this.

    second_opencl_summary.py TESTS.xml STABILITY.json OUT.json

TESTS.xml: the JUnit report of koksma_tests. Prints one line for each.
"""
import json
import pathlib
import sys
import xml.etree.ElementTree


def tests_of(path):
    """Tests and those that failed, with the first message of each."""
    cases = {}
    for case in xml.etree.ElementTree.parse(path).getroot().iter("testcase"):
        name = case.get("name").split("/")[0]
        problem = next((p for p in case if p.tag in ("failure", "error")), None)
        if problem is not None:
            cases.setdefault(name, []).append(" ".join((problem.text or "").split())[:400])
        else:
            cases.setdefault(name, [])
    failed = [{"name": name, "message": messages[0]} for name, messages in cases.items() if messages]
    return {"run": len(cases), "failed": failed}


def suite_of(stability):
    missed = [c for c in stability["cases"] if c["met"] is False]
    return {"device_checks_ok": stability["device_checks"]["ok"], "cases": len(stability["cases"]),
            "missed": [{"scene": c["cell"]["scene"]["text"], "sampler": c["cell"]["sampler"],
                        "precision": c["cell"]["precision"], "faults": c["faults"]} for c in missed]}


def main():
    tests_path, stability_path, out = sys.argv[1:]
    stability = json.loads(pathlib.Path(stability_path).read_text(encoding="utf-8"))
    context = {k: v for k, v in stability["context"].items() if k not in ("study", "command")}
    document = {"schema_version": 1, "context": {"command": "scripts/second_opencl.sh", **context},
                "tests": tests_of(tests_path), "stability": suite_of(stability)}
    pathlib.Path(out).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    tests, suite = document["tests"], document["stability"]
    print(f"{context['device']['platform']} {context['device']['driver']}")
    print(f"tests: {tests['run']} run, {len(tests['failed'])} failed {[t['name'] for t in tests['failed']]}")
    print(f"stability: {suite['cases']} cases, {len(suite['missed'])} missed; device checks "
          f"{'passed' if suite['device_checks_ok'] else 'failed'}\nresults: {out}")


if __name__ == "__main__":
    main()
