/* Checks many certificates in one process, for tests: the checker in C, without its command.

   Standard input holds records: a letter, a length of four bytes, and as many bytes.
   R: the files of a robot, a scene and an SRDF or nothing, a line each; they are read.  C: a certificate about them.
   After each record a byte comes out: the exit code of the command. */
#include <stdio.h>
#include <string.h>

#include "verify.h"

static Given given;
static const Inputs* inputs;

/* Find the pieces of all meshes now: what is taken during a check is freed after it. */
static void find_all_pieces(void) {
  for (size_t i = 0; i < inputs->link_count; ++i) {
    const Link* link = inputs->links + i;
    for (size_t k = 0; k < link->count; ++k) {
      if (link->shapes[k].kind == MESH && !link->shapes[k].convex) find_pieces(link->shapes[k].mesh);
    }
  }
  for (size_t i = 0; i < inputs->obstacle_count; ++i) {
    const Shape* shape = &inputs->obstacles[i].shape;
    if (shape->kind == MESH && !shape->convex) find_pieces(shape->mesh);
  }
}

/* Read files, or check a certificate; return the exit code. */
static int answer(int letter, File record) {
  int code = setjmp(on_failure);
  if (code) return code;
  if (letter == 'R') {
    static const Certificate carries_nothing;
    char *scene = strchr((char*)record.data, '\n'), *srdf = scene ? strchr(scene + 1, '\n') : NULL;
    if (!srdf) fail(BAD_INPUT, "three lines are missing");
    *scene++ = *srdf++ = 0;
    given = (Given){.robot = (char*)record.data, .scene = scene, .srdf = *srdf ? srdf : NULL};
    inputs = read_inputs(given, &carries_nothing);
    find_all_pieces();
  } else {
    const Certificate* certificate = read_certificate(record);
    const Inputs* about = certificate->robot || certificate->scene ? read_inputs(given, certificate) : inputs;
    if (certificate->of_no_path) {
      verify_no_path(about, certificate);
    } else {
      verify(about, certificate);
    }
  }
  return ACCEPTED;
}

int main(void) {
  uint8_t head[5];
  while (fread(head, 1, 5, stdin) == 5) {
    size_t size = (size_t)little_endian(head + 1, 4);
    if (head[0] == 'R') release(NULL);
    void* kept = mark();
    uint8_t* data = take(size + 1, 1);
    if (fread(data, 1, size, stdin) != size) return 1;
    putchar(answer(head[0], (File){data, size}));
    if (head[0] != 'R') release(kept);
    fflush(stdout);
  }
  release(NULL);
  return 0;
}
