"""Pictures as a subscriber with default settings receives them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped, Twist, Vector3
from numpy.typing import NDArray
from PIL import Image as PillowImage
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger
from tf2_msgs.msg import TFMessage

from .live import Graph, Spawn

VIEWS = ("", "/depth", "/segmentation")  # of a camera, where its images and their camera_info are
MEADOW = Path(__file__).with_name("meadow.yaml")


@pytest.fixture(scope="module", autouse=True)
def nodes(spawn: Spawn, tmp_path_factory: pytest.TempPathFactory) -> None:
    spawn("drone_sim.sim_node", scene=MEADOW)
    spawn("drone_render.render_node", use_sim_time=True, image_dir=tmp_path_factory.mktemp("images"))


def picture(image: Image) -> NDArray[np.uint8]:
    """(height, width, 3)."""
    return np.frombuffer(image.data, np.uint8).reshape(image.height, image.step)[:, : 3 * image.width].reshape(
        image.height, image.width, 3
    )


def stamps(messages: list[Any]) -> list[int]:
    return [message.header.stamp.sec * 10**9 + message.header.stamp.nanosec for message in messages]


@pytest.mark.parametrize(("camera", "size"), [("chase", (640, 480)), ("wide", (320, 240))])
def test_frames_are_pictures_in_order(graph: Graph, camera: str, size: tuple[int, int]) -> None:
    images = graph.listen(Image, f"camera/{camera}/image_raw", qos_profile_sensor_data)
    infos = graph.listen(CameraInfo, f"camera/{camera}/camera_info", qos_profile_sensor_data)
    graph.wait_for(lambda: len(images) >= 30, "30 frames")
    graph.wait_for(lambda: infos and stamps(infos)[-1] >= stamps(images)[-1], "as many camera_info")

    assert np.all(np.diff(stamps(images)) > 0)
    assert len(set(stamps(images)) & set(stamps(infos))) > 20
    image, info = images[-1], infos[-1]
    assert (image.width, image.height, image.encoding) == (*size, "rgb8")
    assert (info.width, info.height) == size
    assert image.header.frame_id == info.header.frame_id == f"{camera}_optical"
    assert info.k[0] > 0.0
    colours = picture(image)
    assert 20 < colours.mean() < 235
    assert colours.std() > 15
    assert len(np.unique(colours.reshape(-1, 3), axis=0)) > 50


def test_the_picture_changes_as_the_drone_flies(graph: Graph) -> None:
    images = graph.listen(Image, "camera/chase/image_raw", qos_profile_sensor_data)
    commands = graph.publisher(Twist, "cmd_vel")
    graph.wait_for(lambda: images, "a frame")
    first = picture(images[0]).astype(float)
    with graph.repeating(commands, Twist(linear=Vector3(z=1.0), angular=Vector3(z=1.0))):
        graph.wait_for(lambda: abs(picture(images[-1]) - first).mean() > 5.0, "another picture")


def test_a_picture_is_saved_on_request(graph: Graph) -> None:
    answer = graph.call(Trigger, "drone_render/save_image", Trigger.Request())
    assert answer.success, answer.message
    with PillowImage.open(answer.message) as saved:
        assert saved.format == "PNG"
        assert saved.size == (640, 480)


def test_depth_and_labels_come_with_the_names_of_what_they_show(graph: Graph) -> None:
    depths = graph.listen(Image, "camera/chase/depth/image_raw", qos_profile_sensor_data)
    labels = graph.listen(Image, "camera/chase/segmentation/image_raw", qos_profile_sensor_data)
    names = graph.listen(String, "camera/labels", QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    graph.wait_for(lambda: names and set(stamps(depths)) & set(stamps(labels)), "both of one moment, and names")
    known = yaml.safe_load(names[0].data)
    stamp = min(set(stamps(depths)) & set(stamps(labels)))
    depth, label = (np.frombuffer(images[stamps(images).index(stamp)].data, kind).reshape(480, 640)
                    for images, kind in ((depths, np.float32), (labels, np.uint16)))
    assert (depths[0].encoding, labels[0].encoding) == ("32FC1", "16UC1")
    shown = {known[number] for number in np.unique(label).tolist() if number}
    assert "user_drone" in shown and len(shown) > 1
    drone = next(number for number, name in known.items() if name == "user_drone")
    assert 1.0 < depth[label == drone].min() < 4.0
    assert np.isfinite(depth[label > 0]).all()


def test_a_subscriber_of_all_topics_gets_each_message_once_per_stamp(graph: Graph) -> None:
    images = {view: graph.listen(Image, f"camera/round{view}/image_raw", qos_profile_sensor_data) for view in VIEWS}
    infos = {view: graph.listen(CameraInfo, f"camera/round{view}/camera_info", qos_profile_sensor_data)
             for view in VIEWS}
    around = "round: {orbit: {radius: 5, height: 2, period: 9}, size: [64, 48]}"
    graph.publisher(String, "camera/add").publish(String(data=around))
    places = graph.listen(TFMessage, "tf")

    def together() -> set[int]:
        """Stamps that came with all of them."""
        return set.intersection(*(set(stamps(each[view])) for each in (images, infos) for view in VIEWS))

    def turns() -> list[TransformStamped]:
        return [t for message in places for t in message.transforms if t.child_frame_id == "round"]

    graph.wait_for(lambda: len(together()) > 10 and len(turns()) > 10, "all six and the place, of several moments")
    for view in VIEWS:
        for each in (images[view], infos[view]):
            assert np.all(np.diff(stamps(each)) > 0), view
        assert infos[view][-1].k[0] == infos[""][0].k[0] and infos[view][-1].header.frame_id == "round_optical"
    assert np.all(np.diff(stamps(turns())) > 0)


def test_color_is_not_drawn_for_subscribers_of_depth_alone(graph: Graph) -> None:
    """Nor for subscribers of depth and of the camera_info of color."""
    depths = graph.listen(Image, "camera/deep/depth/image_raw", qos_profile_sensor_data)
    infos = [graph.listen(CameraInfo, f"camera/deep{view}/camera_info", qos_profile_sensor_data) for view in VIEWS[:2]]
    reports = graph.listen(DiagnosticArray, "diagnostics")
    graph.publisher(String, "camera/add").publish(String(data="deep: {pose: [-9, 0, 3], size: [64, 48]}"))
    graph.wait_for(lambda: len(depths) > 10 and all(len(heard) > 10 for heard in infos), "depth images")
    del reports[:]
    graph.wait_for(lambda: sum("pictures" in report.status[0].name for report in reports) > 1, "reports")
    drawn = {value.key for report in reports for value in report.status[0].values}
    assert "frames drawn" in drawn and "ms per frame of deep" not in drawn
    for heard in infos:
        assert np.all(np.diff(stamps(heard)) > 0)
        assert len(set(stamps(depths)) & set(stamps(heard))) > 5


def test_a_camera_is_added_while_it_runs(graph: Graph) -> None:
    images = graph.listen(Image, "camera/side/image_raw", qos_profile_sensor_data)
    add = graph.publisher(String, "camera/add")
    graph.wait_for(lambda: add.get_subscription_count(), "somebody who adds cameras")
    add.publish(String(data="side: {parent: nobody}"))  # refused; the next one is not
    add.publish(String(data="side: {parent: user_drone, pose: [-2, 1, 1], size: [64, 48]}"))
    graph.wait_for(lambda: images, "a picture of the new camera")
    assert (images[0].width, images[0].height, images[0].header.frame_id) == (64, 48, "side_optical")
    assert picture(images[0]).std() > 5


def test_the_debug_view_is_toggled(graph: Graph) -> None:
    images = graph.listen(Image, "camera/wide/image_raw", qos_profile_sensor_data)

    def coloured(image: Image) -> int:
        """How many pixels have a colour that only lines have."""
        red, green, _ = np.moveaxis(picture(image).astype(int), 2, 0)
        return int(((red > green + 60) | (green > red + 60)).sum())

    graph.wait_for(lambda: images, "a frame")
    before = coloured(images[-1])
    assert graph.call(SetBool, "drone_render/show_debug", SetBool.Request(data=True)).success
    graph.wait_for(lambda: coloured(images[-1]) > before + 100, "lines in the picture")
    assert graph.call(SetBool, "drone_render/show_debug", SetBool.Request(data=False)).success
    graph.wait_for(lambda: coloured(images[-1]) < before + 50, "a picture without them")
