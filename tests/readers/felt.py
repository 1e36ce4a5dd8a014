"""Holds a tool and prints what its forces would do to a hand, N, 250 lines a second: as the callback of Tool.run is
given them, as Tool.force has them, and as the newest of a stream. felt.py ENDPOINT TOOL X Y Z"""

import math
import sys
import threading

import palpate


def size(force):
    return 0.0 if force is None else math.hypot(*force.force)


def main():
    endpoint, tool, *place = sys.argv[1:]
    place = [float(x) for x in place]
    streamed = [0.0]
    with palpate.connect(endpoint) as session, session.tool(tool) as held:
        forces = session.forces(tool)

        def listen():
            for force in forces:
                streamed[0] = size(force)

        threading.Thread(target=listen, daemon=True).start()

        coming = 0

        def step(t, force):
            nonlocal coming
            print(size(force), size(held.force), streamed[0], flush=True)
            # Inside a body it would feel nothing: it comes from outside.
            coming = min(coming + 1, 20) if size(force) > 0.0 else (coming + 1) % 120
            above = 0.007 * (1.0 - min(1.0, coming / 20))
            return [place[0], place[1], place[2] + above]

        held.run(step, rate=250.0)


try:
    main()
except (palpate.PalpateError, BrokenPipeError) as error:
    print(error, file=sys.stderr)
