#!/usr/bin/env python3
"""Inverse kinematics of Python packages (their compiled parts included) beside generated code.

    python3 -m venv /tmp/peers && /tmp/peers/bin/pip install numpy ssik eaik roboticstoolbox-python
    /tmp/peers/bin/python bench/peers.py [--patience SECONDS] [ARM ...]

Packages that are not installed are skipped, and so is what takes longer to prepare than SECONDS (120); the report says
so. Times of Python packages hold one call from Python. Where cargo and cmake are there, the line of generated code is
measured in the same run by `bench/peers`, and the ratios are to it.

A solution is right if the plain product of the table's matrices misses the target by less than 1e-6 with it.
`originals` is the share of poses whose own joint angles are among the solutions, `lattice` the share of poses with
joints at quarter turns that get a right solution.
"""

import argparse
import importlib
import math
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
import tomllib

ARMS = ["puma560", "kr6_r900", "ur5", "crx10ia_l", "jaco2", "manocha_canny"]
HERE = pathlib.Path(__file__).resolve().parent
RIGHT = 1e-6

try:
    import numpy as np
except ImportError:
    sys.exit("numpy is not installed: pip install numpy")


class Slow(BaseException):
    """Took longer than there is patience for."""


def within(seconds, work):
    """What `work` gives, or `Slow`."""

    def stop(*_):
        raise Slow

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(max(1, math.ceil(seconds)))
    try:
        return work()
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def number(value, unit):
    """A number of a table in SI: plain numbers in the table's unit; of expressions, what the arms here have."""
    return float(value) * unit if not isinstance(value, str) else float(eval(value, {"pi": math.pi, "__builtins__": {}}))


class Arm:
    """The rows of a table. All that is compared is in theta, without base, tool, offsets and couplings."""

    def __init__(self, name):
        self.name = name
        table = tomllib.loads((HERE.parent / "robots" / f"{name}.toml").read_text())
        robot, joints = table["robot"], table["joint"]
        assert robot["convention"] == "standard", name
        units = robot.get("units", {})
        length = {"m": 1.0, "mm": 1e-3}[units.get("length", "m")]
        angle = {"rad": 1.0, "deg": math.pi / 180}[units.get("angle", "rad")]
        self.a = np.array([number(joint.get("a", 0), length) for joint in joints])
        self.d = np.array([number(joint.get("d", 0), length) for joint in joints])
        self.alpha = np.array([number(joint.get("alpha", 0), angle) for joint in joints])

    def fk(self, theta):
        pose = np.eye(4)
        for t, d, a, alpha in zip(theta, self.d, self.a, self.alpha):
            (st, ct), (sa, ca) = (math.sin(t), math.cos(t)), (math.sin(alpha), math.cos(alpha))
            row = [[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0, sa, ca, d], [0, 0, 0, 1]]
            pose = pose @ np.array(row)
        return pose


class Ssik:
    """ssik: subproblems, and the Raghavan-Roth pencil for general arms."""

    module = "ssik"

    def __init__(self, arm, package):
        self.robot = package.Manipulator.from_dh(arm.alpha, arm.a, arm.d)
        self.robot.prepare()
        self.name = f"ssik {package.__version__}, {self.robot.solver_name}"

    def solve(self, pose):
        return [solution.q for solution in self.robot.solve(pose, respect_limits=False, enumerate_windings=False)]


class Eaik:
    """EAIK: subproblems in C++."""

    module = "eaik.IK_DH"

    def __init__(self, arm, package):
        self.robot = package.DhRobot(arm.alpha, arm.a, arm.d)
        if not self.robot.hasKnownDecomposition():
            raise NotImplementedError("it knows no decomposition of this arm")
        self.name = f"EAIK, {self.robot.getKinematicFamily()}"

    def solve(self, pose):
        return list(self.robot.IK(pose).Q)


class Toolbox:
    """Robotics Toolbox: Levenberg-Marquardt in C from random starts; one solution."""

    module = "roboticstoolbox"

    def __init__(self, arm, package):
        rows = [package.RevoluteDH(d=d, a=a, alpha=alpha) for d, a, alpha in zip(arm.d, arm.a, arm.alpha)]
        self.robot = package.DHRobot(rows).ets()
        self.name = "roboticstoolbox, ik_LM (one solution)"

    def solve(self, pose):
        found = self.robot.ik_LM(pose, tol=1e-14, joint_limits=False)
        return [found.q] if found.success else []


def measured(arm, solver, patience):
    """The figures of a solver on an arm."""
    generator = np.random.default_rng(20260101)
    thetas = generator.uniform(-math.pi, math.pi, (10_000, 6))
    lattice = generator.integers(-2, 2, (200, 6)) * (math.pi / 2)
    right = lambda q, pose: np.abs(arm.fk(q) - pose).max() < RIGHT

    def solved(pose):
        try:
            return solver.solve(pose)
        except (ValueError, RuntimeError, np.linalg.LinAlgError):
            return []

    start, tried, reached = time.perf_counter(), 0, 0
    for theta in lattice:
        pose = arm.fk(theta)
        reached += any(right(q, pose) for q in solved(pose))
        tried += 1
        if time.perf_counter() - start > patience / 4:
            break
    poses = [arm.fk(theta) for theta in thetas[:20]]
    start = time.perf_counter()
    for pose in poses:
        solved(pose)
    one = (time.perf_counter() - start) / len(poses)
    count = int(min(len(thetas), max(20, patience / 12 / one)))
    poses = [arm.fk(theta) for theta in thetas[:count]]
    seconds, answers = math.inf, []
    for _ in range(3):
        start = time.perf_counter()
        answers = [solved(pose) for pose in poses]
        seconds = min(seconds, (time.perf_counter() - start) / count)
    good = [[q for q in found if right(q, pose)] for found, pose in zip(answers, poses)]
    apart = lambda q, theta: np.abs((np.asarray(q) - theta + math.pi) % (2 * math.pi) - math.pi).max()
    return {
        "us": seconds * 1e6,
        "poses": count,
        "solutions": sum(map(len, good)) / count,
        "wrong": sum(len(found) - len(ok) for found, ok in zip(answers, good)) / count,
        "worst": max((np.abs(arm.fk(q) - pose).max() for ok, pose in zip(good, poses) for q in ok), default=0.0),
        "originals": sum(any(apart(q, theta) < 1e-6 for q in ok) for ok, theta in zip(good, thetas)) / count,
        "lattice": reached / tried,
    }


def generated(name):
    """Microseconds a pose of generated code, by `bench/peers`; `None` where that can't be had."""
    if not (shutil.which("cargo") and shutil.which("cmake")):
        print("SKIPPED: generated code, for want of cargo and cmake")
        return None
    command = ["cargo", "run", "--release", "--quiet", "--", "--ours", name]
    run = subprocess.run(command, cwd=HERE / "peers", capture_output=True, text=True)
    found = re.search(r"generated code +([0-9.]+)", run.stdout)
    if found is None:
        print(f"SKIPPED: generated code for {name}: {(run.stdout + run.stderr).strip()[-200:]}")
        return None
    print(run.stdout.strip("\n"))
    return float(found[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--patience", type=float, default=120, help="seconds to prepare a solver, and to run it")
    parser.add_argument("arms", nargs="*", default=ARMS, metavar="ARM")
    arguments = parser.parse_args()
    packages = []
    for peer in (Ssik, Eaik, Toolbox):
        try:
            packages.append((peer, importlib.import_module(peer.module)))
        except ImportError as error:
            print(f"SKIPPED: {peer.__doc__.split(':')[0]} is not installed ({error})")
    for name in arguments.arms:
        arm = Arm(name)
        ours = generated(name)
        print(f"{name}, Python packages (us a pose; as above)")
        for peer, package in packages:
            start = time.perf_counter()
            try:
                solver = within(arguments.patience, lambda: peer(arm, package))
                preparation = time.perf_counter() - start
                line = within(4 * arguments.patience, lambda: measured(arm, solver, arguments.patience))
            except Slow:
                print(f"  SKIPPED: {peer.__name__} takes more than {arguments.patience:.0f} s to prepare")
                continue
            except (NotImplementedError, ValueError, RuntimeError) as error:
                print(f"  SKIPPED: {peer.__name__}: {str(error).splitlines()[0][:100]}")
                continue
            ratio = f"{line['us'] / ours:8.2f}" if ours else "       -"
            print(
                f"  {solver.name:<38} {line['us']:>10.3f} {ratio} {line['poses']:>7} {line['solutions']:>9.4f} "
                f"{line['wrong']:>7.4f} {line['worst']:>9.1e} {100 * line['originals']:>8.2f}% "
                f"{100 * line['lattice']:>7.2f}%  prepared in {preparation:.2f} s",
                flush=True,
            )


if __name__ == "__main__":
    main()
