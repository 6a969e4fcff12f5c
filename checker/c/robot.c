#include <string.h>

#include "inputs.h"

enum { MOST_LINKS = 2000, MOST_FOLDERS = 40 };

size_t link_named(const Inputs* inputs, const char* name) {
  for (size_t i = 0; i < inputs->link_count; ++i) {
    if (!strcmp(inputs->links[i].name, name)) return i;
  }
  return NONE;
}

size_t joint_named(const Inputs* inputs, const char* name) {
  for (size_t i = 0; i < inputs->joint_count; ++i) {
    if (!strcmp(inputs->joints[i].name, name)) return i;
  }
  return NONE;
}

static Pose pose_of(const Entry* owner, const char* where) {
  double xyz[3] = {0, 0, 0}, rpy[3] = {0, 0, 0};
  const Entry* origin = only_child_of(owner, "origin");
  for (const Entry* each = origin ? origin->child : NULL; each; each = each->next) {
    if (strcmp(each->key, "@xyz") != 0 && strcmp(each->key, "@rpy") != 0) {
      fail(BAD_INPUT, "%s: <origin> has %.40s", where, each->key);
    }
  }
  numbers_of(origin, "@xyz", xyz, 3, where);
  numbers_of(origin, "@rpy", rpy, 3, where);
  return pose_of_angles(rpy, (Vector){xyz[0], xyz[1], xyz[2]});
}

/* The path of a mesh: of a package given by name, or in a folder of that name beside or above the URDF. */
static char* mesh_path(const char* name, const char* urdf, const Files* files) {
  static const char package[] = "package://", file[] = "file://";
  if (files->own) return joined(name, "", "");
  if (!strncmp(name, file, strlen(file))) return joined(name + strlen(file), "", "");
  if (strncmp(name, package, strlen(package)) != 0) return joined(*name == '/' ? "" : folder_of(urdf), name, "");
  const char* inside = name + strlen(package);
  size_t width = strcspn(inside, "/");
  for (size_t i = 0; i < files->package_count; ++i) {
    const char* given = files->packages[i];
    if (!strncmp(given, inside, width) && given[width] == '=') return joined(given + width + 1, inside + width, "");
  }
  char* above = folder_of(urdf);
  for (int i = 0; i < MOST_FOLDERS; ++i) {
    char* path = joined(above, inside, "");
    if (exists(path)) return path;
    above = joined(above, "../", "");
  }
  fail(BAD_INPUT, "no file for %.200s: name its folder by --package", name);
}

static Mesh* mesh_of(const Entry* element, const char* urdf, Files* files) {
  double scale[3] = {1, 1, 1};
  const char* path = mesh_path(required(element, "@filename", "a mesh"), urdf, files);
  const char* text = text_of(element, "@scale", "1 1 1");
  bool one = !text[strcspn(text, " \t\r\n")];
  read_numbers(text, scale, one ? 1 : 3, path);
  if (one) scale[1] = scale[2] = scale[0];
  return read_mesh(next_file(files, path), path, scale, false);
}

bool read_size(Shape* shape, const Entry* entry, const char* const keys[3], const char* where) {
  if (shape->kind == BOX) read_numbers(required(entry, keys[0], where), shape->size, 3, where);
  if (shape->kind != BOX) read_numbers(required(entry, keys[1], where), shape->size, 1, where);
  if (shape->kind > SPHERE) read_numbers(required(entry, keys[2], where), shape->size + 1, 1, where);
  for (int i = 0; i < 3; ++i) {
    if (shape->size[i] < 0) fail(BAD_INPUT, "%s: a size below 0", where);
  }
  return shape->size[0] + shape->size[1] + shape->size[2] > 0 && (shape->kind != CAPSULE || shape->size[0] > 0);
}

/* Read the shapes of a link; those of no size are none. */
static void read_collisions(Link* link, const Entry* element, const char* urdf, Files* files) {
  static const char* const keys[] = {"@size", "@radius", "@length"};
  size_t count = 0;
  for (const Entry* each = element->child; each; each = each->next) count += !strcmp(each->key, "collision");
  link->shapes = take(count + 1, sizeof *link->shapes);
  for (const Entry* each = element->child; each; each = each->next) {
    if (strcmp(each->key, "collision") != 0) continue;
    const Entry *geometry = only_child_of(each, "geometry"), *of = geometry ? geometry->child : NULL;
    Shape shape = {.pose = pose_of(each, link->name)};
    while (of && shape.kind < PLANE && strcmp(of->key, kind_names[shape.kind]) != 0) ++shape.kind;
    if (!of || of->next || shape.kind == PLANE) fail(BAD_INPUT, "link %s: no single shape that is read", link->name);
    if (shape.kind == MESH) shape.mesh = mesh_of(of, urdf, files);
    if (shape.kind == MESH || read_size(&shape, of, keys, link->name)) link->shapes[link->count++] = shape;
  }
}

static void read_limits(Joint* joint, const Entry* element, const char* type) {
  const Entry* limit = only_child_of(element, "limit");
  joint->limited = strcmp(type, "continuous") != 0;
  if (!joint->limited || joint->kind == FIXED) return;
  if (!limit) fail(BAD_INPUT, "joint %s has no limits", joint->name);
  numbers_of(limit, "@lower", &joint->lower, 1, joint->name);
  numbers_of(limit, "@upper", &joint->upper, 1, joint->name);
}

static void read_joint(Inputs* inputs, Joint* joint, const Entry* element) {
  const char* type = required(element, "@type", joint->name);
  bool turns = !strcmp(type, "revolute") || !strcmp(type, "continuous"), slides = !strcmp(type, "prismatic");
  /* Joints of several coordinates stand still at 0. */
  bool fixed = !strcmp(type, "fixed") || !strcmp(type, "floating") || !strcmp(type, "planar");
  joint->kind = turns ? TURNS : slides ? SLIDES : FIXED;
  if (!turns && !slides && !fixed) fail(BAD_INPUT, "joint %s is of a type that is not read: %s", joint->name, type);
  joint->parent = link_named(inputs, required(only_child_of(element, "parent"), "@link", joint->name));
  joint->child = link_named(inputs, required(only_child_of(element, "child"), "@link", joint->name));
  if (joint->parent == NONE || joint->child == NONE) fail(BAD_INPUT, "joint %s: no such link", joint->name);
  if (inputs->links[joint->child].parent_joint != NONE) fail(BAD_INPUT, "joint %s: a second parent", joint->name);
  inputs->links[joint->child].parent_joint = (size_t)(joint - inputs->joints);
  joint->pose = pose_of(element, joint->name);
  double axis[3] = {1, 0, 0};
  numbers_of(only_child_of(element, "axis"), "@xyz", axis, 3, joint->name);
  joint->axis = (Vector){axis[0], axis[1], axis[2]};
  if (joint->kind != FIXED && !(length(joint->axis) > 1e-9)) fail(BAD_INPUT, "joint %s: no axis", joint->name);
  if (joint->kind != FIXED) joint->axis = scaled(1 / length(joint->axis), joint->axis);
  read_limits(joint, element, type);
  const Entry* mimic = joint->kind == FIXED ? NULL : only_child_of(element, "mimic");
  joint->follows = NONE;
  joint->multiplier = 1;
  if (!mimic) return;
  numbers_of(mimic, "@multiplier", &joint->multiplier, 1, joint->name);
  numbers_of(mimic, "@offset", &joint->offset, 1, joint->name);
  joint->follows = joint_named(inputs, required(mimic, "@joint", joint->name));
  if (joint->follows == NONE) fail(BAD_INPUT, "joint %s mimics no joint", joint->name);
}

/* Refuse what is no tree: each link but one has a parent, and its chain ends at that one. */
static void require_tree(Inputs* inputs, const char* path) {
  inputs->root = NONE;
  for (size_t i = 0; i < inputs->link_count; ++i) {
    if (inputs->links[i].parent_joint != NONE) continue;
    if (inputs->root != NONE) fail(BAD_INPUT, "%s: two roots", path);
    inputs->root = i;
  }
  for (size_t i = 0; i < inputs->link_count; ++i) {
    size_t link = i, steps = 0;
    while (inputs->links[link].parent_joint != NONE && steps++ <= inputs->joint_count) {
      link = inputs->joints[inputs->links[link].parent_joint].parent;
    }
    if (link != inputs->root) fail(BAD_INPUT, "%s: links in a ring", path);
  }
}

/* Read the tree of links and joints; `read_collisions` follows. */
static void read_tree(Inputs* inputs, const Entry* robot, const char* path) {
  size_t links = 0, joints = 0;
  for (const Entry* each = robot->child; each; each = each->next) {
    links += !strcmp(each->key, "link");
    joints += !strcmp(each->key, "joint");
  }
  if (links > MOST_LINKS || joints > MOST_LINKS) fail(BAD_INPUT, "%s: more than %d links", path, MOST_LINKS);
  inputs->links = take(links + 1, sizeof *inputs->links);
  inputs->joints = take(joints + 1, sizeof *inputs->joints);
  for (const Entry* each = robot->child; each; each = each->next) {
    bool link = !strcmp(each->key, "link"), joint = !strcmp(each->key, "joint");
    const char* name = link || joint ? required(each, "@name", path) : "";
    if ((link && link_named(inputs, name) != NONE) || (joint && joint_named(inputs, name) != NONE)) {
      fail(BAD_INPUT, "%s: two of one name: %s", path, name);
    }
    if (link) inputs->links[inputs->link_count++] = (Link){.name = name, .parent_joint = NONE};
    if (joint) inputs->joints[inputs->joint_count++] = (Joint){.name = name};
  }
  size_t joint = 0;
  for (const Entry* each = robot->child; each; each = each->next) {
    if (!strcmp(each->key, "joint")) read_joint(inputs, inputs->joints + joint++, each);
  }
  require_tree(inputs, path);
}

/* Set an entry of the table for both orders of two links, if the robot has both. */
static void set_pair(Inputs* inputs, size_t a, size_t b, bool value) {
  if (a == NONE || b == NONE) return;
  inputs->disabled[a * inputs->link_count + b] = inputs->disabled[b * inputs->link_count + a] = value;
}

/* Read which pairs an SRDF disables: by a link's default unless they are enabled, then one by one. */
static void read_srdf(Inputs* inputs, const Entry* srdf) {
  static const char* const tags[] = {"disable_default_collisions", "enable_collisions", "disable_collisions"};
  size_t count = inputs->link_count;
  inputs->disabled = take(count * count, sizeof *inputs->disabled);
  for (int i = 0; i < 3; ++i) {
    for (const Entry* each = srdf->child; each; each = each->next) {
      if (strcmp(each->key, tags[i]) != 0) continue;
      size_t a = link_named(inputs, required(each, i ? "@link1" : "@link", tags[i]));
      if (i) set_pair(inputs, a, link_named(inputs, required(each, "@link2", tags[i])), i == 2);
      for (size_t k = 0; !i && k < count; ++k) set_pair(inputs, a, k, true);
    }
  }
  for (size_t a = 0; a < count; ++a) {
    for (size_t b = 0; b < a; ++b) inputs->disabled_count += inputs->disabled[a * count + b];
  }
}

static Entry* parsed(File file, const char* path) {
  if (strstr((const char*)file.data, "<xacro:")) fail(BAD_INPUT, "%s is a xacro", path);
  Entry* robot = parse_xml((const char*)file.data, file.size, path);
  if (strcmp(robot->key, "robot") != 0) fail(BAD_INPUT, "%s is no URDF or SRDF", path);
  return robot;
}

void read_robot(Inputs* inputs, const char* urdf, const char* srdf, Files* files) {
  const Entry* robot = parsed(next_file(files, urdf), urdf);
  read_tree(inputs, robot, urdf);
  File pairs = {NULL, 0};
  if (srdf) pairs = next_file(files, srdf);
  if (pairs.size) read_srdf(inputs, parsed(pairs, srdf));
  for (const Entry* link = robot->child; link; link = link->next) {
    if (strcmp(link->key, "link") != 0) continue;
    read_collisions(inputs->links + link_named(inputs, text_of(link, "@name", "")), link, urdf, files);
  }
}
