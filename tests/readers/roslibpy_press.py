"""roslibpy presses the ball of a daemon over rosbridge and hears its forces.

    roslibpy_press.py URL    prints the largest force, how many came, and what a service answered
"""

import json
import sys
import time

import roslibpy


def main(url):
    ros = roslibpy.Ros(url)
    ros.run(timeout=30)
    poses = roslibpy.Topic(ros, "/arm/measured_cp", "geometry_msgs/PoseStamped")
    forces = roslibpy.Topic(ros, "/arm/body/servo_cf", "geometry_msgs/WrenchStamped")
    heard = []
    forces.subscribe(lambda message: heard.append(message["wrench"]["force"]["x"]))
    poses.advertise()
    pose = {
        "position": {"x": 0.0255, "y": 0.003, "z": 0.045},
        "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
    }
    begun = time.monotonic()
    # From outside, again for as long as nothing is felt: inside the body it would feel nothing.
    coming = 0
    while max(heard, default=0.0) < 0.5 or time.monotonic() - begun < 1.0:
        if time.monotonic() - begun > 60.0:
            sys.exit("no force in a minute")
        coming = min(coming + 1, 20) if max(heard, default=0.0) > 0.0 else (coming + 1) % 250
        pose["position"]["x"] = 0.0255 + 0.0105 * (1.0 - min(1.0, coming / 20))
        poses.publish({"header": {"frame_id": "world"}, "pose": pose})
        time.sleep(0.002)
    pause = roslibpy.Service(ros, "/palpate/pause", "std_srvs/Trigger")
    answer = pause.call(roslibpy.ServiceRequest(), timeout=20)
    print(json.dumps({"peak": max(heard), "count": len(heard), "answer": dict(answer)}))
    sys.stdout.flush()
    ros.terminate()


main(sys.argv[1])
