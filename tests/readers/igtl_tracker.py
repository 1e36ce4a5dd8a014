"""pyigtl as a tracker and a viewer of a daemon with --igtl.

    igtl_tracker.py PORT    moves the ball in and hears where its proxy is; prints how far it got, mm
"""

import json
import sys
import time

import numpy
import pyigtl


def main(port):
    client = pyigtl.OpenIGTLinkClient("127.0.0.1", port)
    begun = time.monotonic()
    while not client.is_connected():
        if time.monotonic() - begun > 30.0:
            sys.exit("no connection")
        time.sleep(0.05)
    seen, k = [], 0
    while time.monotonic() - begun < 60.0:
        k += 1
        matrix = numpy.eye(4)
        # From beside the drop to 12 mm inside it, mm.
        matrix[:3, 3] = [max(36.0 - 0.05 * k, 24.0), 3.0, 45.0]
        client.send_message(pyigtl.TransformMessage(matrix, device_name="ball"), wait=True)
        message = client.wait_for_message("ball", timeout=0.02)
        if message is not None:
            seen.append(float(message.matrix[0, 3]))
            if k > 400 and len(seen) > 20:
                break
        time.sleep(0.005)
    print(json.dumps({"first": seen[0], "last": seen[-1], "count": len(seen)}))
    client.stop()


main(int(sys.argv[1]))
