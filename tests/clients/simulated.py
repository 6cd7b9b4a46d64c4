"""A simulated device under `dhc sim`, for the makers' clients to speak to."""

import json
import subprocess


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
