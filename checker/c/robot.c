#include <math.h>
#include <string.h>

#include "inputs.h"

enum { MOST_LINKS = 2000 };

void add_shape(Shapes* shapes, Shape shape) {
  if (shapes->count == shapes->room) {
    shapes->room = 2 * shapes->room + 4;
    Shape* more = take(shapes->room, sizeof *more);
    if (shapes->count) memcpy(more, shapes->shapes, shapes->count * sizeof *more);
    shapes->shapes = more;
  }
  shapes->shapes[shapes->count++] = shape;
}

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

static const char* required(const Entry* element, const char* key, const char* where) {
  const char* text = text_of(element, key, NULL);
  if (!text) fail(BAD_INPUT, "%s: no %s", where, key + 1);
  return text;
}

/* Numbers of an attribute, which keep their values where there is none. */
static void numbers_of(const Entry* element, const char* key, double* numbers, size_t count, const char* where) {
  const char* text = element ? text_of(element, key, NULL) : NULL;
  if (text) read_numbers(text, numbers, count, where);
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
static char* mesh_path(const char* name, Places places) {
  static const char package[] = "package://", file[] = "file://";
  if (!strncmp(name, file, strlen(file))) return joined(name + strlen(file), "", "");
  if (strncmp(name, package, strlen(package)) != 0) return joined(*name == '/' ? "" : places.folder, name, "");
  const char* inside = name + strlen(package);
  size_t width = strcspn(inside, "/");
  for (size_t i = 0; i < places.package_count; ++i) {
    const char* given = places.packages[i];
    if (!strncmp(given, inside, width) && given[width] == '=') return joined(given + width + 1, inside + width, "");
  }
  char* above = joined(places.folder, "", "");
  for (int i = 0; i < 40; ++i) {
    char* path = joined(above, inside, "");
    if (exists(path)) return path;
    above = joined(above, "../", "");
  }
  fail(BAD_INPUT, "no file for %.200s: name its folder by --package", name);
}

static void read_mesh_of(Shape* shape, const Entry* element, Places places, Sha256* hash) {
  double scale[3] = {1, 1, 1};
  const char* path = mesh_path(required(element, "@filename", "a mesh"), places);
  const char* text = text_of(element, "@scale", "1 1 1");
  bool one = !text[strcspn(text, " \t\r\n")];
  read_numbers(text, scale, one ? 1 : 3, path);
  if (one) scale[1] = scale[2] = scale[0];
  Mesh* mesh = read_mesh(read_file(path, hash), path);
  for (size_t i = 0; i < 3 * mesh->triangles; ++i) {
    Vector* corner = mesh->corners + i;
    *corner = (Vector){scale[0] * corner->x, scale[1] * corner->y, scale[2] * corner->z};
  }
  shape->kind = MESH;
  shape->mesh = mesh;
}

static void read_collision(Link* link, const Entry* collision, Places places, Sha256* hash) {
  static const char* const kinds[] = {"box", "sphere", "cylinder", "capsule", "mesh"};
  const Entry *geometry = only_child_of(collision, "geometry"), *element = geometry ? geometry->child : NULL;
  Shape shape = {.pose = pose_of(collision, link->name)};
  for (int i = 0; element && i < 5; ++i) {
    if (!strcmp(element->key, kinds[i])) shape.kind = i + BOX;
  }
  if (!shape.kind || element->next) fail(BAD_INPUT, "link %s: no single shape that is read", link->name);
  if (shape.kind == BOX) {
    read_numbers(required(element, "@size", link->name), shape.size, 3, link->name);
  } else if (shape.kind == MESH) {
    read_mesh_of(&shape, element, places, hash);
  } else {
    read_numbers(required(element, "@radius", link->name), shape.size, 1, link->name);
    if (shape.kind != SPHERE) read_numbers(required(element, "@length", link->name), shape.size + 1, 1, link->name);
  }
  for (int i = 0; i < 3; ++i) {
    if (shape.size[i] < 0) fail(BAD_INPUT, "link %s: a size below 0", link->name);
  }
  add_shape(&link->shapes, shape);
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
  joint->kind = !strcmp(type, "fixed")                                     ? FIXED
                : !strcmp(type, "revolute") || !strcmp(type, "continuous") ? TURNS
                : !strcmp(type, "prismatic")                               ? SLIDES
                                                                           : 0;
  if (!joint->kind) fail(BAD_INPUT, "joint %s is of a type that is not read: %s", joint->name, type);
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
  if (strcmp(robot->key, "robot") != 0) fail(BAD_INPUT, "%s: no URDF", path);
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

static Entry* parsed(const char* path, Sha256* hash) {
  File file = read_file(path, hash);
  if (strstr((const char*)file.data, "<xacro:")) fail(BAD_INPUT, "%s is a xacro", path);
  return parse_xml((const char*)file.data, file.size, path);
}

Inputs* read_inputs(const char* urdf, const char* scene, const char* srdf, Places places) {
  Inputs* inputs = take(1, sizeof *inputs);
  Sha256 hash;
  sha256_begin(&hash);
  places.folder = folder_of(urdf);
  const Entry* robot = parsed(urdf, &hash);
  read_tree(inputs, robot, urdf);
  if (srdf) read_srdf(inputs, parsed(srdf, &hash));
  for (const Entry* link = robot->child; link; link = link->next) {
    if (strcmp(link->key, "link") != 0) continue;
    Link* to = inputs->links + link_named(inputs, text_of(link, "@name", ""));
    for (const Entry* each = link->child; each; each = each->next) {
      if (!strcmp(each->key, "collision")) read_collision(to, each, places, &hash);
    }
  }
  read_scene(inputs, scene, &hash);
  sha256_end(&hash, inputs->digest);
  return inputs;
}
