#!/usr/bin/python3
"""Parses every launch file of the package, with the arguments that change its shape, and checks what it would start.

usage: check_launch_files.py SOURCE_FOLDER

velodyne_pointcloud may be absent: a folder with its launch file's arguments then stands in for it.
Exit codes: 0 all good, 1 something is not, 2 bad usage, 3 no roslaunch here.
"""
import os
import re
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

PACKAGE = "fail_aware_lidar_odometry"
BAG = "drive with blank.bag"  # in a temporary folder
EMPTY_BAG = "empty.bag"  # likewise
FITTED = "fitted.yaml"  # likewise
OWN = {"profile": "profiles/default.yaml", "vehicle": "vehicles/passat_b6.yaml", "sensor": "sensors/hdl64e.yaml"}  # copied there
FITTED_TEXT = "monitor:\n  drift:\n    scale_bias: 0.5\n"
CASES = {
    "odometry.launch": [{}, {"rviz": "true"}, {"respawn": "true"}, {"start_manager": "false", "manager": "/other"}, {"profile": "paper"},
                        {"namespace": "second"}, {"parameters": FITTED}, OWN],
    "kitti_replay.launch": [{"bag": BAG}, {"bag": BAG, "bag_tf": "true"}, {"play": "false"}, {"play": "false", "parameters": FITTED},
                            {"bag": BAG, "loop": "true", "rviz": "true"}],
    "velodyne_hdl64e.launch": [{}, {"driver": "false"}, {"calibration": "/data/head.yaml", "rviz": "true"},
                               {"parameters": FITTED}, OWN,
                               {"timestamp_first_packet": "true"}, {"gps_time": "true", "respawn": "true"},
                               {"pcap": "/data/head.pcap", "pcap_time": "true", "read_once": "true", "max_range": "90.0"}],
    "demo.launch": [{}, {"publish_tf": "false"}],
}
DRIVER = """<launch>
  %s
  <node pkg="nodelet" type="nodelet" name="$(arg manager)" args="manager"/>
  <node pkg="nodelet" type="nodelet" name="$(arg manager)_driver" args="load velodyne_driver/DriverNodelet $(arg manager)">
    <param name="cut_angle" type="double" value="$(arg cut_angle)"/>
    <param name="gps_time" value="$(arg gps_time)"/>
    <param name="pcap_time" value="$(arg pcap_time)"/>
    <param name="timestamp_first_packet" value="$(arg timestamp_first_packet)"/>
  </node>
</launch>
""" % "\n  ".join('<arg name="%s" default="false"/>' % name for name in (
    "calibration", "device_ip", "frame_id", "manager", "max_range", "min_range", "pcap", "port", "read_fast", "read_once",
    "repeat_delay", "rpm", "gps_time", "pcap_time", "cut_angle", "timestamp_first_packet", "laserscan_ring", "laserscan_resolution"))


def stand_in_for_driver(folder):
    package = os.path.join(folder, "velodyne_pointcloud")
    os.makedirs(os.path.join(package, "launch"))
    with open(os.path.join(package, "package.xml"), "w") as file:
        file.write("<package><name>velodyne_pointcloud</name><version>0.0.0</version><description/>"
                   "<maintainer email='a@b.c'>x</maintainer><license>BSD</license></package>")
    with open(os.path.join(package, "launch", "64e_S3.launch"), "w") as file:
        file.write(DRIVER)


TWO_VEHICLES = """<launch>
  <group ns="car_1"><include file="%(file)s"><arg name="cloud" value="/car_1/points"/><arg name="rviz" value="true"/></include></group>
  <group ns="car_2"><include file="%(file)s"><arg name="cloud" value="/car_2/points"/><arg name="rviz" value="true"/></include></group>
</launch>
"""


def write_bag(path, said=("hello",)):
    import rosbag
    import std_msgs.msg
    with rosbag.Bag(path, "w") as bag:
        for text in said:
            bag.write("/said", std_msgs.msg.String(text))


def load(path, arguments):
    import roslaunch.config
    import roslaunch.xmlloader
    config = roslaunch.config.ROSLaunchConfig()
    loader = roslaunch.xmlloader.XmlLoader(resolve_anon=False)
    loader.load(path, config, argv=["%s:=%s" % pair for pair in arguments.items()], verbose=False)
    if config.config_errors:
        raise AssertionError("; ".join(config.config_errors))
    return config


def expect(condition, message):
    if not condition:
        raise AssertionError(message)


def check(root, name, arguments, config, nodelets):
    names = {node.name: node for node in config.nodes}
    values = {key: parameter.value for key, parameter in config.params.items()}
    namespace = "/" + arguments.get("namespace", PACKAGE)
    loaded = [node.args.split()[1].split("/")[1] for node in config.nodes
              if node.package == "nodelet" and node.args.startswith("load %s/" % PACKAGE)]
    expect(sorted(loaded) == sorted(set(loaded)), "a nodelet is loaded twice")
    expect(set(loaded) <= nodelets, "not in nodelet_plugins.xml: %s" % (set(loaded) - nodelets))
    expect({"SweepCorrection", "IcpPointToPoint", "IcpPointToPlane", "CornerSvd", "FusionUkf",
            "FailAwareMonitor"} <= set(loaded), "a nodelet is missing: %s" % loaded)
    expect(("rviz" in names) == (arguments.get("rviz") == "true"), "rviz")
    for key in ("profile/registration/use_icp_point_to_point", "profile/fusion/min_weight", "vehicle/cog_in_base", "sensor/lidar_in_base"):
        expect("%s/%s" % (namespace, key) in values, "no parameter %s" % key)
    literal = values["%s/profile/fusion/literal" % namespace]
    expect(literal == (arguments.get("profile") == "paper"), "the profile over default and expert")
    fitted = values["%s/profile/monitor/drift/scale_bias" % namespace] == 0.5
    expect(fitted == ("parameters" in arguments), "parameters over the profile's")
    for kind in OWN:
        own = values.get("%s/%s/said" % (namespace, kind))
        expect(own == ("own" if kind in arguments and "/" in arguments[kind] else None), "%s of one's own" % kind)
    managers = [node for node in config.nodes if node.package == "nodelet" and node.args == "manager"]
    expect(len(managers) == (0 if arguments.get("start_manager") == "false" else 1), "managers: %d" % len(managers))

    publish_tf = values["%s/fusion_ukf/publish_tf" % namespace]
    expect(isinstance(publish_tf, bool), "publish_tf is no bool: %r" % publish_tf)
    if name == "kitti_replay.launch":
        bag_tf = arguments.get("bag_tf") == "true"
        expect(publish_tf != bag_tf, "base_link would have two parents, or none")
        expect(values["/use_sim_time"] is True, "use_sim_time")
        expect(values[namespace + "/sensor/timing/stamp_reference"] == "mid", "stamp_reference")
        expect(values[namespace + "/sensor/vertical_angle/angle_deg"] == 0.205, "vertical_angle")
        expect(("rosbag_play" in names) == ("bag" in arguments), "rosbag play")
        if "bag" in arguments:
            play = names["rosbag_play"]
            expect("'%s'" % arguments["bag"] in play.args and "--clock" in play.args, play.args)
            expect(("--loop" in play.args) == ("loop" in arguments), play.args)
            expect(play.remap_args == ([] if bag_tf else [["/tf", "/kitti/tf"]]), play.remap_args)
    else:
        expect(publish_tf is (arguments.get("publish_tf") != "false"), "publish_tf")
    own = [node for node in config.nodes if node.args.startswith("load %s/" % PACKAGE)]
    expect(all(node.respawn is (arguments.get("respawn") == "true") for node in own), "respawn")
    if name == "velodyne_hdl64e.launch":
        manager = "manager" if arguments.get("driver") == "false" else "/velodyne_nodelet_manager"
        fusion = names["fusion_ukf"]
        expect(fusion.args.split()[2] == manager, fusion.args)
        for key in ("gps_time", "pcap_time", "timestamp_first_packet") if arguments.get("driver") != "false" else ():
            passed_on = values["/velodyne_nodelet_manager_driver/%s" % key]
            expect(passed_on is (arguments.get(key) == "true"), "%s: %r" % (key, passed_on))
        first_packet = arguments.get("timestamp_first_packet") == "true"
        expect(values[namespace + "/sensor/timing/stamp_reference"] == ("start" if first_packet else "auto"),
               "stamp_reference")


def check_bag_is_refused(root, bag):
    try:
        load(os.path.join(root, "launch", "kitti_replay.launch"), {"bag": bag})
    except Exception as error:  # a parser's any
        expect("rosbag" in str(error), str(error))
        return
    raise AssertionError("it would start without a bag to play")


def check_sensor_is_refused(root, sensor):
    try:
        load(os.path.join(root, "launch", "odometry.launch"), {"sensor": sensor})
    except Exception as error:  # a parser's any
        stems = sorted(name[:-len(".yaml")] for name in os.listdir(os.path.join(root, "cfg", "sensors")))
        expect("sensor:=%s (there are: %s;" % (sensor, ", ".join(stems)) in str(error), str(error))
        return
    raise AssertionError("it would start without a sensor file")


def check_two_vehicles(root, folder):
    """Under one master nothing of one vehicle is the other's."""
    path = os.path.join(folder, "two_vehicles.launch")
    with open(path, "w") as file:
        file.write(TWO_VEHICLES % {"file": os.path.join(root, "launch", "odometry.launch")})
    config = load(path, {})
    places = [node.namespace + node.name for node in config.nodes] + list(config.params)
    outside = [place for place in places if not re.match("/car_[12]/%s/" % PACKAGE, place)]
    expect(not outside, "not below a vehicle's namespace: %s" % outside)
    expect(sum("/car_1/" in place for place in places) == sum("/car_2/" in place for place in places), "unlike")
    for node in config.nodes:
        for source, target in node.remap_args:
            expect(not target.startswith("/") or target == "/%s/points" % node.namespace.split("/")[1],
                   "%s hears another's %s" % (node.name, target))


def main(arguments):
    if len(arguments) != 1 or not os.path.isdir(arguments[0]):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    root = os.path.abspath(arguments[0])
    try:
        import roslaunch  # noqa: F401
        import rospkg
    except ImportError as error:
        print("no roslaunch: %s" % error)
        return 3
    plugins = ElementTree.parse(os.path.join(root, "nodelet_plugins.xml")).getroot()
    nodelets = {entry.get("name").split("/")[1] for entry in plugins.iter("class")}
    files = sorted(name for name in os.listdir(os.path.join(root, "launch")) if re.search(r"\.launch$", name))
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        path = [root]
        try:
            rospkg.RosPack().get_path("velodyne_pointcloud")
        except rospkg.ResourceNotFound:
            stand_in_for_driver(folder)
            path.append(folder)
        before = os.environ.get("ROS_PACKAGE_PATH", "/usr/share")
        os.environ["ROS_PACKAGE_PATH"] = os.pathsep.join(path + [before])
        write_bag(os.path.join(folder, BAG))
        write_bag(os.path.join(folder, EMPTY_BAG), [])
        with open(os.path.join(folder, FITTED), "w") as file:
            file.write(FITTED_TEXT)
        for path in OWN.values():
            os.makedirs(os.path.dirname(os.path.join(folder, path)))
            with open(os.path.join(root, "cfg", path)) as shipped, open(os.path.join(folder, path), "w") as own:
                own.write(shipped.read() + "said: own\n")
        for bag in ("/no/such.bag", BAG, "", os.path.join(folder, EMPTY_BAG)):
            try:
                check_bag_is_refused(root, bag)
                print("ok: '%s' is refused" % bag)
            except Exception as error:  # a parser's any
                failures += 1
                print("FAILED: bag '%s': %s" % (bag, error))
        for name in files:
            for case in CASES.get(name, [{}]):
                case = {key: os.path.join(folder, value) if value in (BAG, FITTED, *OWN.values()) else value for key, value in case.items()}
                try:
                    config = load(os.path.join(root, "launch", name), case)
                    check(root, name, case, config, nodelets)
                    print("ok: %s %s" % (name, case))
                except Exception as error:  # a parser's any
                    failures += 1
                    print("FAILED: %s %s: %s" % (name, case, error))
        try:
            check_sensor_is_refused(root, "vlp16")
            print("ok: an unknown sensor is refused")
        except Exception as error:  # a parser's any
            failures += 1
            print("FAILED: unknown sensor: %s" % error)
        try:
            check_two_vehicles(root, folder)
            print("ok: two vehicles")
        except Exception as error:  # a parser's any
            failures += 1
            print("FAILED: two vehicles: %s" % error)
    for name in sorted(set(CASES) - set(files)):
        failures += 1
        print("FAILED: launch/%s is missing" % name)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
