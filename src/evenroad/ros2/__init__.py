"""A node of ROS 2, ``evenroad ros2 map``, and the messages that it takes and gives.

Only ``node.py`` and ``map_node.py`` need ROS, and import it when a node starts.  The other modules read values that
have the fields of messages, of any library, and make messages by a maker that they are given.
"""
