"""A session of the unmodified pymycobot with the simulated myCobot: every call is made once, is answered within the
client's first try, and the answer is checked.

python3 mycobot.py PATH_OF_DHC
"""

import os
import tempfile
import termios
import time

from pymycobot import MyCobot280
from pymycobot.error import MyCobot280DataException

from simulated import Simulated, equal, run

# The client sends a request again when half a second has brought no answer.
FIRST_TRY = 0.45


class Session:
    """The client, with a watch on what it sends and how long it takes."""

    def __init__(self, port, baud):
        self.client = MyCobot280(port, baud)
        self.calls = self.written = 0
        self.slowest = 0.0
        write = self.client._serial_port.write

        def counted(data):
            self.written += 1
            return write(data)

        self.client._serial_port.write = counted

    def __getattr__(self, name):
        method = getattr(self.client, name)

        def call(*args, **kwargs):
            start = time.monotonic()
            result = method(*args, **kwargs)
            self.slowest = max(self.slowest, time.monotonic() - start)
            self.calls += 1
            equal(self.written, self.calls, f"requests after {name}")
            return result

        return call


def near(actual, expected, tolerance, what):
    assert isinstance(actual, list) and len(actual) == len(expected), f"{what}: {actual}"
    off = max(abs(a - b) for a, b in zip(actual, expected))
    assert off <= tolerance, f"{what}: {actual}, not {expected}"


def arrive(arm, seconds=10):
    deadline = time.monotonic() + seconds
    while arm.is_moving():
        assert time.monotonic() < deadline, "it never arrives"
        time.sleep(0.05)


def session(dhc):
    with Simulated(dhc, "mycobot") as device:
        arm = Session(device.port, 1000000)
        equal(arm.power_on(), 1, "power on")
        equal(arm.is_power_on(), 1, "is power on")
        equal(arm.is_controller_connected(), 1, "controller")
        equal(arm.is_all_servo_enable(), 1, "all servos")
        equal(arm.is_servo_enable(3), 1, "servo 3")
        equal(arm.get_system_version(), 6.5, "version")
        equal(arm.get_modify_version(), 1, "modification")
        equal(arm.get_error_information(), 0, "error")
        equal([arm.get_joint_min_angle(5), arm.get_joint_max_angle(5)], [-155.0, 160.0], "limits of J5")
        near(arm.get_angles(), [-90, 0, 0, 0, 0, 0], 0, "angles at the start")
        for color in ((255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255)):
            equal(arm.set_color(*color), 1, "colour")

        goal = [-60.5, -20.25, 30.12, -40.5, 50, 60]
        equal(arm.send_angles(goal, 80), 1, "send angles")
        equal(arm.is_moving(), 1, "moving")
        equal(arm.is_in_position(goal, 0), 0, "in position, on the way")
        arrive(arm)
        near(arm.get_angles(), goal, 0.011, "angles at the goal")
        near(arm.get_angles_plan(), goal, 0.011, "the goal itself")
        equal(arm.is_in_position(goal, 0), 1, "in position")
        equal(arm.send_angle(2, 25.5, 80), 1, "send angle")
        arrive(arm)
        near(arm.get_angles(), [-60.5, 25.5, 30.12, -40.5, 50, 60], 0.011, "one joint")
        equal(arm.jog_increment_angle(2, -5.5, 80), 1, "jog by an angle")
        arrive(arm)
        near(arm.get_angles(), [-60.5, 20.0, 30.12, -40.5, 50, 60], 0.021, "once, not twice")
        both = arm.get_angles_coords()
        near(both, arm.get_angles() + arm.get_coords(), 0.02, "angles and coordinates")
        near([tick for tick in arm.get_encoders()], [2048 + round(a * 4096 / 360) for a in both[:6]], 1, "encoders")

        # A published pose; what the device is sent for J1 is 90 degrees less.
        equal(arm.send_angles([-12.08 - 90, -51.17, -123.8, 84.96, 0, -12.08], 100), 1, "send angles")
        arrive(arm)
        near(arm.get_coords()[:3], [149.98707521, -99.99309332, 69.97903252], 0.1, "its published position")

        equal(arm.send_angles([-90, 0, 0, 0, 0, 0], 10), 1, "a slow move")
        equal(arm.pause(), 1, "pause")
        equal(arm.is_paused(), 1, "is paused")
        equal(arm.resume(), 1, "resume")
        equal(arm.is_moving(), 1, "moving again")
        equal(arm.stop(), 1, "stop")
        arrive(arm, 2)
        assert abs(arm.get_angles()[1]) > 5, "it stopped on the way"

        equal(arm.set_gripper_value(40, 100), 1, "gripper value")
        equal(arm.is_gripper_moving(), 1, "gripper moving")
        time.sleep(1)
        equal(arm.get_gripper_value(), 40, "gripper value, read")
        equal(arm.set_gripper_state(0, 100), 1, "gripper open")
        equal([arm.set_fresh_mode(0), arm.get_fresh_mode()], [1, 0], "goals are queued")
        equal([arm.set_fresh_mode(1), arm.get_fresh_mode()], [1, 1], "goals are replaced")

        # The client takes 180 degrees of J6; a limit set in the device refuses it, and latches it.
        equal(arm.set_joint_max(6, 100), 1, "set a limit")
        before = arm.get_angles()
        equal(arm.send_angles([-90, 0, 0, 0, 0, 150], 50), 1, "a goal beyond the device's limit")
        equal(arm.get_error_information(), 6, "the joint")
        equal(arm.is_moving(), 0, "it stays")
        near(arm.get_angles(), before, 0.011, "where it was")
        equal(arm.send_angles([-90, 0, 0, 0, 0, 0], 50), 1, "acknowledged and not made: an error is latched")
        equal(arm.is_moving(), 0, "it still stays")
        equal(arm.clear_error_information(), 1, "cleared")
        equal(arm.send_angles([-90, 0, 0, 0, 0, 0], 100), 1, "and moves")
        arrive(arm)
        near(arm.get_angles(), [-90, 0, 0, 0, 0, 0], 0.011, "home")
        equal(arm.release_all_servos(), 1, "torque off")
        equal(arm.is_all_servo_enable(), 0, "it is off")
        equal(arm.focus_all_servos(), 1, "torque on")
        assert arm.slowest < FIRST_TRY, f"{arm.slowest} s: a reply that came late"
        print(f"  mycobot: {arm.calls} calls, {arm.written} requests, slowest {1000 * arm.slowest:.1f} ms")

        # What the client refuses itself reaches no device.
        for refused in (lambda: arm.send_angles([169, 0, 0, 0, 0, 0], 20), lambda: arm.send_angle(1, 0, 101)):
            try:
                refused()
                raise AssertionError("the client sends it")
            except MyCobot280DataException:
                equal(arm.written, arm.calls, "requests after a refusal")

        # Without power it knows no angles: the client asks three times and gives up.
        equal(arm.power_off(), 1, "power off")
        equal(arm.is_power_on(), 0, "is power on")
        start = time.monotonic()
        equal(arm.client.get_angles(), -1, "angles without power")
        assert 1.4 < time.monotonic() - start < 2.5, "three tries of half a second"


def unplugged(dhc):
    """The device is cut and comes back: the client says so, and goes on after close() and open()."""
    with tempfile.TemporaryDirectory() as folder:
        link = os.path.join(folder, "arm")
        with Simulated(dhc, "mycobot", "--link", link):
            client = MyCobot280(link, 1000000)
            equal(client.get_error_information(), 0, "error")
            # SIGTERM: the program ends well, and the terminal is gone.
        try:
            client.get_angles()
            raise AssertionError("a device that is gone answers")
        except termios.error:
            pass
        with Simulated(dhc, "mycobot", "--link", link):
            client.close()
            client.open()
            near(client.get_angles(), [-90, 0, 0, 0, 0, 0], 0, "angles after it came back")


if __name__ == "__main__":
    run([session, unplugged])
