"""The live graph on a ROS master of its own, for the scripts that measure it."""
import contextlib
import os
import signal
import socket
import subprocess
import threading
import time

from offline_tools import PACKAGE, find_tool

CLOUD = "/kitti/velo/pointcloud"

if not hasattr(threading.Thread, "isAlive"):  # Python 3.9 has it no longer; Debian 11's rospy (1.15.9) calls it when it ends
    threading.Thread.isAlive = threading.Thread.is_alive


class Failure(Exception):
    pass


def run(command, **options):
    finished = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, **options)
    if finished.returncode != 0:
        raise Failure("%s: %s" % (os.path.basename(command[0]), (finished.stderr or finished.stdout).strip()))
    return finished.stdout


def wait_until(condition, patience_s, what, processes):
    end = time.time() + patience_s
    while not condition():
        for name, process in processes.items():
            if process.poll() not in (None, 0):
                raise Failure("%s ended with exit code %s" % (name, process.returncode))
        if time.time() > end:
            raise Failure("%s: not within %.0f s" % (what, patience_s))
        time.sleep(0.2)


def subscribers(master, topic):
    state = master.getSystemState()
    return [node for name, nodes in state[1] if name == topic for node in nodes]


def stop(process):
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def free_port():
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


def is_up(master):
    """All six nodelets are loaded."""
    try:
        published = {name for name, _ in master.getSystemState()[0]}
    except OSError:
        return False
    except Exception:  # the master's own errors, while it starts
        return False
    names = ["odometry", "sweep/points", "time_to_failure", "measurement/icp_point_to_point",
             "measurement/icp_point_to_plane", "measurement/corner_svd"]
    return all("/%s/%s" % (PACKAGE, name) in published for name in names)


class LiveGraph:
    """What is launched, and what is started beside it: name -> process."""

    def __init__(self, port, log):
        import rosgraph
        self._log = log
        self.environment = dict(os.environ, ROS_MASTER_URI="http://localhost:%d" % port, ROS_HOSTNAME="localhost")
        self.master = rosgraph.Master("/" + PACKAGE + "_scripts", "http://localhost:%d" % port)
        self.processes = {}

    def join(self, name):
        """Makes this process a node of the graph's; rospy is imported then only, as it reads the environment."""
        os.environ.update(self.environment)
        import rospy
        rospy.init_node(name, disable_signals=True, log_level=rospy.FATAL)
        return rospy

    def start(self, name, command, **options):
        self.processes[name] = subprocess.Popen(command, env=self.environment, **options)

    def wait_for(self, condition, patience_s, what):
        wait_until(condition, patience_s, what, self.processes)

    def wait_for_listeners(self, topic, count, what):
        self.wait_for(lambda: len(subscribers(self.master, topic)) >= count, 60.0, what)

    def play(self, bag, *options):
        self.start("rosbag play", ["rosbag", "play", "--clock", "--quiet", "--delay", "5", bag, "/tf:=/kitti/tf"] + list(options),
                   stdout=subprocess.DEVNULL, stderr=self._log, stdin=subprocess.DEVNULL)


@contextlib.contextmanager
def launched_graph(launch_file, arguments, log_path, port=0):
    """A LiveGraph whose nodelets are all up; everything is stopped when the block is left."""
    port = port or free_port()
    with open(log_path, "w") as log:
        graph = LiveGraph(port, log)
        try:
            graph.start("roslaunch", ["roslaunch", "-p", str(port), PACKAGE, launch_file] + arguments, stdout=log, stderr=subprocess.STDOUT)
            graph.wait_for(lambda: is_up(graph.master), 120.0, "the odometry's start")
            yield graph
        finally:
            for process in reversed(list(graph.processes.values())):
                stop(process)


def replay_graph(arguments, log_path, port=0):
    return launched_graph("kitti_replay.launch", ["play:=false"] + arguments, log_path, port)


def bag_of(drive, folder):
    """The drive itself if it is a bag; a folder in KITTI's layout is made one."""
    bag = os.path.abspath(drive)
    if not os.path.isdir(bag):
        return bag
    times = ["--point-times"] if os.path.isdir(os.path.join(bag, "stamps")) else []
    made = os.path.join(os.path.abspath(folder), "drive.bag")
    run([find_tool("kitti_to_bag", Failure), bag, made] + times)
    return made
