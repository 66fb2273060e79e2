"""Runs a method that is a Python file, by the protocol of README.md: python3 run_method.py FILE"""

import importlib.util
import json
import os
import sys
import time
import traceback

replies = sys.stdout
sys.stdout = sys.stderr  # what a method prints must not get among the replies


def say(reply):
    print(json.dumps(reply), file=replies, flush=True)


def measure(method, folder, runs):
    def mesh(name, fields):
        return {field: numpy.load(os.path.join(folder, f"{name}_{field}.npy")) for field in fields}

    cage = mesh("cage", ["positions", "indices", "uvs"])
    target = mesh("target", ["positions", "indices", "groups"])
    seconds = []
    for run in range(runs + 1):
        own = [{field: array.copy() for field, array in one.items()} for one in (cage, target)]  # a method may write into it
        began = time.perf_counter()
        zones = method.zones(*own)
        if run > 0:
            seconds.append(time.perf_counter() - began)
    if zones is None:
        raise TypeError("zones() returned None; is a return missing?")
    zones = numpy.asarray(zones)
    if zones.dtype == object:
        raise TypeError("zones() returned what is no array of numbers")
    numpy.save(os.path.join(folder, "zones.npy"), zones)
    return seconds


try:
    import numpy

    file = sys.argv[1]
    sys.path.insert(0, os.path.dirname(os.path.abspath(file)))
    spec = importlib.util.spec_from_file_location("method", file)
    method = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(method)
    if not callable(getattr(method, "zones", None)):
        raise TypeError(f"{file} has no function called zones")
    if hasattr(method, "prepare"):
        method.prepare()
    say({"ready": True})
    for line in sys.stdin:
        request = json.loads(line)
        say({"seconds": measure(method, request["folder"], request["runs"])})
except Exception as error:
    traceback.print_exc()
    say({"error": f"{type(error).__name__}: {error}"})
