// The module that any processor runs: it names the builds of the kernel that this processor runs, the newest last.
//
// With -DEVENROAD_NEWEST it is a program instead, which CMake runs to build for this processor alone.
#include "bind/processor.hpp"

#ifdef EVENROAD_NEWEST
#include <cstdio>

int main() { return std::fputs(evenroad::bind::VARIANTS[evenroad::bind::count_runnable() - 1], stdout) < 0; }
#else
#include <Python.h>

namespace {

PyObject* runnable(PyObject*, PyObject*) {
  const int count = evenroad::bind::count_runnable();
  PyObject* names = PyTuple_New(count);
  for (int i = 0; names != nullptr && i < count; i++) {
    PyTuple_SetItem(names, i, PyUnicode_FromString(evenroad::bind::VARIANTS[i]));
  }
  return names;
}

PyMethodDef METHODS[] = {
    {"runnable", runnable, METH_NOARGS, "Return the names of the builds that this processor runs, the newest last."},
    {nullptr, nullptr, 0, nullptr}};

PyModuleDef MODULE = {PyModuleDef_HEAD_INIT, "_cpu", nullptr, 0, METHODS, nullptr, nullptr, nullptr, nullptr};

}  // namespace

PyMODINIT_FUNC PyInit__cpu() { return PyModule_Create(&MODULE); }
#endif
