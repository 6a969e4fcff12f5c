"""Fields of types of MoveIt, nav2 and ros2_control, as these have them in Jazzy, by the kind of message."""

MOVEIT = {
    "object_recognition_msgs/msg/ObjectType": "string key\nstring db",
    "octomap_msgs/msg/Octomap": "std_msgs/Header header\nbool binary\nstring id\nfloat64 resolution\nint8[] data",
    "octomap_msgs/msg/OctomapWithPose": (
        "std_msgs/Header header\ngeometry_msgs/Pose origin\noctomap_msgs/Octomap octomap"
    ),
    "moveit_msgs/msg/CollisionObject": (
        "std_msgs/Header header\ngeometry_msgs/Pose pose\nstring id\nobject_recognition_msgs/ObjectType type\n"
        "shape_msgs/SolidPrimitive[] primitives\ngeometry_msgs/Pose[] primitive_poses\n"
        "shape_msgs/Mesh[] meshes\ngeometry_msgs/Pose[] mesh_poses\n"
        "shape_msgs/Plane[] planes\ngeometry_msgs/Pose[] plane_poses\n"
        "string[] subframe_names\ngeometry_msgs/Pose[] subframe_poses\nbyte operation"
    ),
    "moveit_msgs/msg/AttachedCollisionObject": (
        "string link_name\nmoveit_msgs/CollisionObject object\nstring[] touch_links\n"
        "trajectory_msgs/JointTrajectory detach_posture\nfloat64 weight"
    ),
    "moveit_msgs/msg/RobotState": (
        "sensor_msgs/JointState joint_state\nsensor_msgs/MultiDOFJointState multi_dof_joint_state\n"
        "moveit_msgs/AttachedCollisionObject[] attached_collision_objects\nbool is_diff"
    ),
    "moveit_msgs/msg/AllowedCollisionEntry": "bool[] enabled",
    "moveit_msgs/msg/AllowedCollisionMatrix": (
        "string[] entry_names\nmoveit_msgs/AllowedCollisionEntry[] entry_values\n"
        "string[] default_entry_names\nbool[] default_entry_values"
    ),
    "moveit_msgs/msg/LinkPadding": "string link_name\nfloat64 padding",
    "moveit_msgs/msg/LinkScale": "string link_name\nfloat64 scale",
    "moveit_msgs/msg/ObjectColor": "string id\nstd_msgs/ColorRGBA color",
    "moveit_msgs/msg/PlanningSceneWorld": (
        "moveit_msgs/CollisionObject[] collision_objects\noctomap_msgs/OctomapWithPose octomap"
    ),
    "moveit_msgs/msg/PlanningScene": (
        "string name\nmoveit_msgs/RobotState robot_state\nstring robot_model_name\n"
        "geometry_msgs/TransformStamped[] fixed_frame_transforms\n"
        "moveit_msgs/AllowedCollisionMatrix allowed_collision_matrix\n"
        "moveit_msgs/LinkPadding[] link_padding\nmoveit_msgs/LinkScale[] link_scale\n"
        "moveit_msgs/ObjectColor[] object_colors\nmoveit_msgs/PlanningSceneWorld world\nbool is_diff"
    ),
}
"""Planning scenes, which rosbags does not know."""

OTHERS = {
    "map_msgs/msg/OccupancyGridUpdate": (
        "std_msgs/Header header\nint32 x\nint32 y\nuint32 width\nuint32 height\nint8[] data"
    ),
    "nav2_msgs/action/ComputePathToPose": """geometry_msgs/PoseStamped goal
geometry_msgs/PoseStamped start
string planner_id
bool use_start
---
uint16 NONE=0
uint16 UNKNOWN=200
uint16 INVALID_PLANNER=201
uint16 TF_ERROR=202
uint16 START_OUTSIDE_MAP=203
uint16 GOAL_OUTSIDE_MAP=204
uint16 START_OCCUPIED=205
uint16 GOAL_OCCUPIED=206
uint16 TIMEOUT=207
uint16 NO_VALID_PATH=208
nav_msgs/Path path
builtin_interfaces/Duration planning_time
uint16 error_code
---
""",
    "control_msgs/msg/JointTolerance": "string name\nfloat64 position\nfloat64 velocity\nfloat64 acceleration",
    "control_msgs/msg/JointComponentTolerance": (
        "string joint_name\nuint16 component\nfloat64 position\nfloat64 velocity\nfloat64 acceleration"
    ),
    "control_msgs/action/FollowJointTrajectory": """trajectory_msgs/JointTrajectory trajectory
trajectory_msgs/MultiDOFJointTrajectory multi_dof_trajectory
JointTolerance[] path_tolerance
JointComponentTolerance[] component_path_tolerance
JointTolerance[] goal_tolerance
JointComponentTolerance[] component_goal_tolerance
builtin_interfaces/Duration goal_time_tolerance
---
int32 error_code
int32 SUCCESSFUL = 0
int32 INVALID_GOAL = -1
int32 INVALID_JOINTS = -2
int32 OLD_HEADER_TIMESTAMP = -3
int32 PATH_TOLERANCE_VIOLATED = -4
int32 GOAL_TOLERANCE_VIOLATED = -5
string error_string
---
std_msgs/Header header
string[] joint_names
trajectory_msgs/JointTrajectoryPoint desired
trajectory_msgs/JointTrajectoryPoint actual
trajectory_msgs/JointTrajectoryPoint error
string[] multi_dof_joint_names
trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_desired
trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_actual
trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_error
""",
    "moveit_msgs/msg/JointConstraint": (
        "string joint_name\nfloat64 position\nfloat64 tolerance_above\nfloat64 tolerance_below\nfloat64 weight"
    ),
    "moveit_msgs/msg/BoundingVolume": (
        "shape_msgs/SolidPrimitive[] primitives\ngeometry_msgs/Pose[] primitive_poses\n"
        "shape_msgs/Mesh[] meshes\ngeometry_msgs/Pose[] mesh_poses"
    ),
    "moveit_msgs/msg/PositionConstraint": (
        "std_msgs/Header header\nstring link_name\ngeometry_msgs/Vector3 target_point_offset\n"
        "BoundingVolume constraint_region\nfloat64 weight"
    ),
    "moveit_msgs/msg/OrientationConstraint": (
        "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nstring link_name\n"
        "float64 absolute_x_axis_tolerance\nfloat64 absolute_y_axis_tolerance\nfloat64 absolute_z_axis_tolerance\n"
        "uint8 parameterization\nuint8 XYZ_EULER_ANGLES=0\nuint8 ROTATION_VECTOR=1\nfloat64 weight"
    ),
    "moveit_msgs/msg/VisibilityConstraint": (
        "float64 target_radius\ngeometry_msgs/PoseStamped target_pose\nint32 cone_sides\n"
        "geometry_msgs/PoseStamped sensor_pose\nfloat64 max_view_angle\nfloat64 max_range_angle\n"
        "uint8 sensor_view_direction\nfloat64 weight"
    ),
    "moveit_msgs/msg/Constraints": (
        "string name\nJointConstraint[] joint_constraints\nPositionConstraint[] position_constraints\n"
        "OrientationConstraint[] orientation_constraints\nVisibilityConstraint[] visibility_constraints"
    ),
    "moveit_msgs/msg/TrajectoryConstraints": "Constraints[] constraints",
    "moveit_msgs/msg/WorkspaceParameters": (
        "std_msgs/Header header\ngeometry_msgs/Vector3 min_corner\ngeometry_msgs/Vector3 max_corner"
    ),
    "moveit_msgs/msg/CartesianPoint": (
        "geometry_msgs/Pose pose\ngeometry_msgs/Twist velocity\ngeometry_msgs/Accel acceleration"
    ),
    "moveit_msgs/msg/CartesianTrajectoryPoint": "CartesianPoint point\nbuiltin_interfaces/Duration time_from_start",
    "moveit_msgs/msg/CartesianTrajectory": (
        "std_msgs/Header header\nstring tracked_frame\nCartesianTrajectoryPoint[] points"
    ),
    "moveit_msgs/msg/GenericTrajectory": (
        "std_msgs/Header header\ntrajectory_msgs/JointTrajectory[] joint_trajectory\n"
        "CartesianTrajectory[] cartesian_trajectory"
    ),
    "moveit_msgs/msg/RobotTrajectory": (
        "trajectory_msgs/JointTrajectory joint_trajectory\n"
        "trajectory_msgs/MultiDOFJointTrajectory multi_dof_joint_trajectory"
    ),
    "moveit_msgs/msg/MoveItErrorCodes": """int32 val
string message
string source
int32 UNDEFINED=0
int32 SUCCESS=1
int32 FAILURE=99999
int32 PLANNING_FAILED=-1
int32 INVALID_MOTION_PLAN=-2
int32 TIMED_OUT=-6
int32 PREEMPTED=-7
int32 START_STATE_IN_COLLISION=-10
int32 GOAL_IN_COLLISION=-12
int32 INVALID_GROUP_NAME=-15
int32 INVALID_GOAL_CONSTRAINTS=-16
int32 INVALID_ROBOT_STATE=-17
int32 INVALID_LINK_NAME=-18
int32 FRAME_TRANSFORM_FAILURE=-21
int32 ROBOT_STATE_STALE=-23
int32 START_STATE_INVALID=-26
int32 GOAL_STATE_INVALID=-27
int32 NO_IK_SOLUTION=-31
""",
    "moveit_msgs/msg/MotionPlanRequest": (
        "WorkspaceParameters workspace_parameters\nRobotState start_state\nConstraints[] goal_constraints\n"
        "Constraints path_constraints\nTrajectoryConstraints trajectory_constraints\n"
        "GenericTrajectory[] reference_trajectories\nstring pipeline_id\nstring planner_id\nstring group_name\n"
        "int32 num_planning_attempts\nfloat64 allowed_planning_time\nfloat64 max_velocity_scaling_factor\n"
        "float64 max_acceleration_scaling_factor\nstring cartesian_speed_limited_link\nfloat64 max_cartesian_speed"
    ),
    "moveit_msgs/msg/MotionPlanResponse": (
        "RobotState trajectory_start\nstring group_name\nRobotTrajectory trajectory\nfloat64 planning_time\n"
        "MoveItErrorCodes error_code"
    ),
    "moveit_msgs/srv/GetMotionPlan": (
        "MotionPlanRequest motion_plan_request\n---\nMotionPlanResponse motion_plan_response"
    ),
}
"""Requests and actions, which only nodes have."""
