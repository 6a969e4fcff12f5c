/* Checks many certificates in one process, for tests: the checker in C, without its command.

   Standard input holds records: a letter, a length of four bytes, and as many bytes.
   R: the files of a robot, a scene and an SRDF or nothing, a line each; they are read.  C: a certificate about them.
   After each record a byte comes out: the exit code of the command. */
#include <stdio.h>
#include <string.h>

#include "verify.h"

static Given given;
static const Inputs* inputs;

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
  } else {
    const Certificate* certificate = read_certificate(record);
    verify(certificate->robot || certificate->scene ? read_inputs(given, certificate) : inputs, certificate);
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
