"""What scripts/report is made of. Needs numpy and matplotlib; for bags also Debian's python3-rosbag."""
