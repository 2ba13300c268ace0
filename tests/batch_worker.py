"""A vectorised simulator for tests: f = (x1 + x2, (x1 - 1)^2). With `together` it wants eight designs at once and notes in a file how many came.
Designs with x1 below 0.1 end it, those with x1 above 0.9 have no result, those with x2 above 0.975 are answered too late."""
import json
import sys
import time

together = sys.argv[1] == "together"
for line in sys.stdin:
    asked = json.loads(line)
    designs = asked if isinstance(asked, list) else [asked]
    with open(sys.argv[2], "a") as f:
        print(len(designs), file=f)
    if any(d["x"][0] < 0.1 for d in designs):
        sys.exit(3)
    if any(d["x"][1] > 0.975 for d in designs):
        time.sleep(60)
    answers = [{"id": d["id"], "error": "no"} if d["x"][0] > 0.9 else {"id": d["id"], "f": [sum(d["x"]), (d["x"][0] - 1) ** 2]}
               for d in designs]
    if together:
        answers[0]["batch"] = 8
    print(json.dumps(answers if len(designs) > 1 else answers[0]), flush=True)
