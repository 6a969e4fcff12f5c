/* Checks many certificates in one process, for tests: the checker in C, without its command.

   Standard input holds records: a letter, a length of four bytes, and as many bytes.
   R: the files of a robot, a scene and an SRDF or nothing, a line each; they are read.  C: a certificate about them.
   After each record a byte comes out, the exit code of the command; after R also the digest of the files. */
#include <stdio.h>
#include <string.h>

#include "verify.h"

static Inputs* inputs;

/* Read files, or check a certificate; return the exit code. */
static int answer(int letter, File record) {
  static Places places;
  int code = setjmp(on_failure);
  if (code) return code;
  if (letter == 'R') {
    char *robot = (char*)record.data, *scene = strchr(robot, '\n'), *srdf = scene ? strchr(scene + 1, '\n') : NULL;
    if (!srdf) fail(BAD_INPUT, "three lines are missing");
    *scene++ = *srdf++ = 0;
    inputs = read_inputs(robot, scene, *srdf ? srdf : NULL, places);
  } else {
    if (!inputs) fail(BAD_INPUT, "no files were read");
    verify(inputs, record);
  }
  return ACCEPTED;
}

int main(void) {
  uint8_t head[5];
  while (fread(head, 1, 5, stdin) == 5) {
    size_t size = head[1] | (size_t)head[2] << 8 | (size_t)head[3] << 16 | (size_t)head[4] << 24;
    if (head[0] == 'R') {
      release(NULL);
      inputs = NULL;
    }
    void* kept = mark();
    uint8_t* data = take(size + 1, 1);
    if (fread(data, 1, size, stdin) != size) return 1;
    int code = answer(head[0], (File){data, size});
    if (head[0] != 'R') release(kept);
    putchar(code);
    if (head[0] == 'R') fwrite(code ? head : inputs->digest, 1, code ? 0 : 32, stdout);
    fflush(stdout);
  }
  release(NULL);
  return 0;
}
