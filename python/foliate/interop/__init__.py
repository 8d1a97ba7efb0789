"""Other programs' data: each module needs its package when it is used, and no other.

``pinocchio``: configurations in the order of a pinocchio model. ``messages``: trajectories as dictionaries like ROS messages. ``moveit``: planning scenes as
dictionaries. ``viser``: plays a path in the browser. ``mujoco``: replays a path with position control.
"""
