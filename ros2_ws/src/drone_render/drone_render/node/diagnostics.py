"""The diagnostics message that the node publishes once a second."""

from collections.abc import Mapping, Sequence

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from drone_sim.wire.cdr import SECOND


def diagnostics(
    device: str, drawing: bool, time_ns: int, values: Mapping[str, object], times: Sequence[KeyValue]
) -> DiagnosticArray:
    """device: name of the graphics device; drawing: whether a scene is loaded; times: ms per picture of each camera."""
    status = DiagnosticStatus(name="drone_render: pictures", hardware_id=device)
    status.level, status.message = DiagnosticStatus.OK, "drawing" if drawing else "waiting for a scene"
    status.values = [*(KeyValue(key=key, value=str(value)) for key, value in values.items()), *times]
    message = DiagnosticArray(status=[status])
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(time_ns, SECOND)
    return message
