"""A worker for simulators that read a file and write another (docs/external.md): for every design a new folder, an input made
from a template, the simulator run in it, numbers found in what it wrote.

    python3 driver.py --template beam.tpl --run 'solver beam > out.txt' --output out.txt --objective 'mass = (\\S+)' ...

In the template {x1}, {x2}, ... are the variables in their order, words included; what is called beam.tpl is beam in the new
folder. The command is the shell's; $START is the folder where imtet was started. Each pattern is a regular expression whose group
is the number; its last place in the output counts. A design fails where the command does, or where a pattern finds nothing: the
reason names it with the last line that the simulator printed."""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile


def options():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--template", required=True, metavar="FILE")
    p.add_argument("--run", required=True, metavar="COMMAND")
    p.add_argument("--output", metavar="FILE", help="where the numbers are; what the command prints unless given")
    p.add_argument("--objective", action="append", required=True, metavar="PATTERN", help="one for each objective")
    p.add_argument("--constraint", action="append", default=[], metavar="PATTERN", help="kept where it is at most 0")
    return p.parse_args()


def fill(template, x, name):
    """The template with the variables in it; others than x1 to xn are a mistake of the template."""
    def value(match):
        i = int(match[1])
        if not 1 <= i <= len(x):
            line = template.count("\n", 0, match.start()) + 1
            sys.exit(f"{name}:{line}: {match[0]}, but the problem has {len(x)} variables (problem.variables)")
        return str(x[i - 1])
    return re.sub(r"\{x(\d+)\}", value, template)


def number(pattern, text, where):
    found = re.findall(pattern, text)
    if not found:
        raise ValueError(f"'{pattern}' is not in {where}")
    return float(found[-1])


def evaluate(o, template, x, base):
    with tempfile.TemporaryDirectory(dir=base) as folder:
        with open(os.path.join(folder, os.path.basename(o.template).removesuffix(".tpl")), "w") as f:
            f.write(fill(template, x, o.template))
        run = subprocess.run(o.run, shell=True, cwd=folder, env={**os.environ, "START": os.getcwd()}, text=True, errors="replace",
                             stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        last = run.stdout.strip().rpartition("\n")[2]
        if run.returncode != 0:
            raise ValueError(f"'{o.run}' ended with {run.returncode}: {last}")
        try:
            text = open(os.path.join(folder, o.output), errors="replace").read() if o.output else run.stdout
            where = o.output or "what it printed"
            answer = {"f": [number(p, text, where) for p in o.objective]}
            if o.constraint:
                answer["g"] = [number(p, text, where) for p in o.constraint]
        except (OSError, ValueError) as e:
            raise ValueError(f"{e}: {last}") from None
        return answer


def main():
    o = options()
    with open(o.template) as f:
        template = f.read()
    base = tempfile.mkdtemp(prefix="imtet-")
    # Removes it whatever ends this process, in a session of its own: where a design is too late imtet kills the worker.
    subprocess.Popen(["sh", "-c", 'cat; rm -rf "$0"', base], stdin=subprocess.PIPE, start_new_session=True)
    for line in sys.stdin:
        request = json.loads(line)
        try:
            answer = evaluate(o, template, request["x"], base)
        except ValueError as e:
            answer = {"error": str(e)}
        print(json.dumps({"id": request["id"], **answer}), flush=True)


main()
