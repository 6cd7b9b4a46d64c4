"""Sessions of the unmodified dynamixel-sdk with simulated servos: every call is made once and must succeed.

python3 dynamixel.py PATH_OF_DHC
"""

import os
import tempfile
import termios
import time

from dynamixel_sdk import (
    COMM_RX_TIMEOUT,
    COMM_SUCCESS,
    GroupBulkRead,
    GroupBulkWrite,
    GroupSyncRead,
    GroupSyncWrite,
    PacketHandler,
    PortHandler,
)

from simulated import Simulated, equal, run

TORQUE, PROFILE_VELOCITY, GOAL, MOVING, POSITION = 64, 112, 116, 122, 132


def open_port(name, baud):
    port = PortHandler(name)
    assert port.openPort() and port.setBaudRate(baud), f"{name} opens at {baud}"
    return port


def little_endian(value):
    return list(value.to_bytes(4, "little", signed=True))


def planar_arm(dhc):
    """Two XL430: everything that the client can ask of them."""
    with Simulated(dhc, "planar2r") as device:
        port, bus = open_port(device.port, 57600), PacketHandler(2.0)
        for servo in (1, 2):
            equal(bus.ping(port, servo), (1060, COMM_SUCCESS, 0), "ping")
        equal(bus.ping(port, 9)[1], COMM_RX_TIMEOUT, "ping of a servo that is not there")
        equal(bus.broadcastPing(port), ({1: [1060, 46], 2: [1060, 46]}, COMM_SUCCESS), "broadcast ping")
        for servo in (1, 2):
            equal(bus.write4ByteTxRx(port, servo, PROFILE_VELOCITY, 100), (COMM_SUCCESS, 0), "profile velocity")
            equal(bus.write1ByteTxRx(port, servo, TORQUE, 1), (COMM_SUCCESS, 0), "torque on")
        equal(bus.write4ByteTxRx(port, 1, GOAL, 5000), (COMM_SUCCESS, 6), "a goal outside the limits")
        equal(bus.write4ByteTxRx(port, 1, POSITION, 0), (COMM_SUCCESS, 7), "a register that is read-only")

        goals = {1: 3000, 2: 1500}
        write = GroupSyncWrite(port, bus, GOAL, 4)
        read = GroupSyncRead(port, bus, POSITION, 4)
        for servo, goal in goals.items():
            assert write.addParam(servo, little_endian(goal)) and read.addParam(servo)
        equal(write.txPacket(), COMM_SUCCESS, "sync write")
        equal(bus.read1ByteTxRx(port, 1, MOVING), (1, COMM_SUCCESS, 0), "moving, on the way")
        deadline = time.monotonic() + 5
        positions = {}
        while positions != goals and time.monotonic() < deadline:
            equal(read.txRxPacket(), COMM_SUCCESS, "sync read")
            positions = {servo: read.getData(servo, POSITION, 4) for servo in goals}
            time.sleep(0.05)
        equal(positions, goals, "where they are after the move")
        equal(bus.read1ByteTxRx(port, 1, MOVING), (0, COMM_SUCCESS, 0), "moving, there")
        equal(read.fastSyncRead(), COMM_SUCCESS, "fast sync read")
        equal({servo: read.getData(servo, POSITION, 4) for servo in goals}, goals, "fast sync read")

        bulk = GroupBulkRead(port, bus)
        assert bulk.addParam(1, POSITION, 4) and bulk.addParam(2, 144, 2)
        equal(bulk.txRxPacket(), COMM_SUCCESS, "bulk read")
        equal((bulk.getData(1, POSITION, 4), bulk.getData(2, 144, 2)), (3000, 120), "bulk read")
        bulk = GroupBulkWrite(port, bus)
        assert bulk.addParam(1, GOAL, 4, little_endian(2900)) and bulk.addParam(2, 65, 1, [1])
        equal(bulk.txPacket(), COMM_SUCCESS, "bulk write")
        equal(bus.read1ByteTxRx(port, 2, 65), (1, COMM_SUCCESS, 0), "the LED")
        equal(bus.regWriteTxRx(port, 2, GOAL, 4, little_endian(1600)), (COMM_SUCCESS, 0), "reg write")
        equal(bus.read1ByteTxRx(port, 2, 69), (1, COMM_SUCCESS, 0), "registered")
        equal(bus.action(port, 254), COMM_SUCCESS, "action")
        equal(bus.read4ByteTxRx(port, 2, GOAL), (1600, COMM_SUCCESS, 0), "the goal after the action")

        equal(bus.write1ByteTxRx(port, 1, TORQUE, 0), (COMM_SUCCESS, 0), "torque off")
        # The client does not stuff what it sends; servos frame by the length and take it all the same.
        equal(bus.write4ByteTxRx(port, 1, 20, -131073), (COMM_SUCCESS, 0), "ff ff fd ff")
        equal(bus.read4ByteTxRx(port, 1, 20), (0xFFFDFFFF, COMM_SUCCESS, 0), "ff ff fd ff, read back")
        equal(bus.write4ByteTxRx(port, 1, 20, 0), (COMM_SUCCESS, 0), "homing offset")
        equal(bus.reboot(port, 1), (COMM_SUCCESS, 0), "reboot")
        equal(bus.ping(port, 1)[1], COMM_RX_TIMEOUT, "a servo that starts")
        time.sleep(0.3)
        equal(bus.ping(port, 1), (1060, COMM_SUCCESS, 0), "ping after reboot")
        port.closePort()
    print("two XL430: every call was answered the first time")


def crane_x7(dhc):
    """Eight servos at 3 Mbaud: a thousand sync reads while they move, none lost."""
    with Simulated(dhc, "crane_x7") as device:
        port, bus = open_port(device.port, 3000000), PacketHandler(2.0)
        servos = range(2, 10)
        equal([bus.ping(port, servo)[0] for servo in servos], [1020, 1120] + 6 * [1020], "models")
        write = GroupSyncWrite(port, bus, GOAL, 4)
        read = GroupSyncRead(port, bus, 126, 10)
        for servo in servos:
            equal(bus.write4ByteTxRx(port, servo, PROFILE_VELOCITY, 20), (COMM_SUCCESS, 0), "profile velocity")
            equal(bus.write1ByteTxRx(port, servo, TORQUE, 1), (COMM_SUCCESS, 0), "torque on")
            assert read.addParam(servo)
        times = []
        for turn in range(1000):
            if turn % 100 == 0:
                write.clearParam()
                for servo in servos:
                    write.addParam(servo, little_endian(2048 + (200 if turn % 200 else -200)))
                equal(write.txPacket(), COMM_SUCCESS, "sync write")
            start = time.perf_counter()
            equal(read.txRxPacket(), COMM_SUCCESS, f"sync read {turn}")
            times.append(1e3 * (time.perf_counter() - start))
            for servo in servos:
                assert read.isAvailable(servo, POSITION, 4), f"servo {servo} in sync read {turn}"
                assert 1840 <= read.getData(servo, POSITION, 4) <= 2256
        port.closePort()
    times.sort()
    print(
        f"eight servos at 3 Mbaud: 1000 sync reads, none lost; "
        f"median {times[500]:.2f} ms, 99 % {times[990]:.2f} ms, longest {times[-1]:.2f} ms"
    )


def cut(dhc):
    """The line is cut and comes back: the client goes on after what its makers prescribe, a new openPort."""
    with tempfile.TemporaryDirectory() as folder:
        link = os.path.join(folder, "servos")
        first = Simulated(dhc, "planar2r", "--link", link).__enter__()
        port, bus = open_port(link, 57600), PacketHandler(2.0)
        equal(bus.ping(port, 1), (1060, COMM_SUCCESS, 0), "ping")
        first.kill()
        try:
            bus.ping(port, 1)
            raise AssertionError("the line is cut")
        except (termios.error, OSError):
            pass
        with Simulated(dhc, "planar2r", "--link", link):
            # The flag stays set after an exception: the client leaves it to the caller.
            port.is_using = False
            port.closePort()
            assert port.openPort() and port.setBaudRate(57600)
            equal(bus.ping(port, 1), (1060, COMM_SUCCESS, 0), "ping after the cut")
            port.closePort()
    print("cut and come back: the client goes on")


if __name__ == "__main__":
    run([planar_arm, crane_x7, cut])
