"""Nodes of ROS 2, ``evenroad ros2 map`` and ``evenroad ros2 arm``, and the messages that they take and give.

Only ``node.py``, ``map_node.py``, ``arm_node.py`` and ``follow.py`` need ROS, and import it when a node starts.  The
other modules read values that have the fields of messages, of any library, and make messages by a maker that they are
given.
"""
