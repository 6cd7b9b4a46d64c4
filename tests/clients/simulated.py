"""A simulated device under `dhc sim`, for the makers' clients to speak to."""

import json
import os
import subprocess
import sys
import time


class Simulated:
    """`dhc sim TABLE`, as long as the `with` lasts."""

    def __init__(self, dhc, table, *flags):
        self.command = [dhc, "sim", table, *flags]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, text=True)
        self.port = json.loads(self.process.stdout.readline())["port"]
        return self

    def __exit__(self, *_):
        self.process.terminate()
        assert self.process.wait(timeout=5) == 0, "dhc sim ends well when it is told to"

    def kill(self):
        """Cuts the line, as a pulled plug would."""
        self.process.kill()
        self.process.wait()


def equal(found, expected, what):
    assert found == expected, f"{what}: {found} instead of {expected}"


def run(sessions):
    """Runs sessions with the program that the command line names.

    A real device does not wait for a processor; a simulated one may, and the clients grant it some 40 ms of real time. On
    a machine that has more to do than processors to do it with, a session that failed proves nothing and is run again; on
    any other, one failure is a failure.
    """
    for session in sessions:
        for attempt in range(10):
            try:
                session(sys.argv[1])
                break
            except AssertionError as error:
                load, processors = os.getloadavg()[0], os.cpu_count()
                if load <= 1.5 * processors or attempt == 9:
                    raise
                print(f"{session.__name__}: {error}; again, with a load of {load:.1f} on {processors} processors")
                time.sleep(10)
