"""Texts of a xacro: ``${expression}``, ``$(command argument)``, and what stands between them."""

from __future__ import annotations

import os
import re
from collections.abc import Callable

from evenroad.errors import InvalidValue, UnknownName, shown
from evenroad.loading.xacro.expressions import evaluate
from evenroad.loading.xacro.files import Files
from evenroad.loading.xacro.functions import names_of
from evenroad.loading.xacro.values import Budget, Scope, literal

_TOKEN = re.compile(r"\$(\$+[{(])|\$\{([^}]*)\}|\$\(([^)]*)\)|([^$]+|\$(?![{(]))")
"""An escaped bracket, an expression, a command, or plain text."""


class Texts:
    """Evaluates the texts of one xacro; `arguments` grow while it is read."""

    def __init__(self, files: Files, arguments: dict[str, str], budget: Budget) -> None:
        self.files, self.arguments, self.budget = files, arguments, budget
        self._commands: dict[str, Callable[..., str]] = {
            "arg": self._argument,
            "find": files.package,
            "dirname": files.folder,
            "cwd": os.getcwd,
            "env": _environment,
            "optenv": lambda name, *default: os.environ.get(name, " ".join(default)),
        }
        own: dict[str, Callable[..., object]] = {
            "arg": self._argument,
            "load_yaml": files.load_yaml,
            "abs_filename": files.absolute,
            "dotify": dict,
        }
        self.names = Scope(names=names_of(own), evaluate=self.value)

    def value(self, text: str, names: Scope) -> object:
        """Return what a text stands for: one expression alone keeps its type, all else is a text."""
        parts: list[object] = []
        at = 0
        while at < len(text):
            token = _TOKEN.match(text, at)
            if token is None:
                raise InvalidValue(f"a bracket in {shown(text)} does not end")
            at = token.end()
            escaped, expression, command, plain = token.groups()
            if expression is not None:
                # Commands within are replaced first: ${'$(arg side)' == 'left'}.
                parts.append(evaluate(self.text(expression, names), names, self.budget))
            elif command is not None:
                parts.append(self._substituted(self.text(command, names)))
            else:
                parts.append(escaped or plain)
        if len(parts) == 1:
            return self.budget.weigh(parts[0])
        return self.budget.weigh("".join(map(str, parts)))

    def text(self, text: str, names: Scope) -> str:
        """Return what a text stands for, as a text."""
        return str(self.value(text, names)) if "$" in text else text

    def _substituted(self, text: str) -> str:
        name, _, rest = text.strip().partition(" ")
        if name == "eval":
            arguments = {key: literal(value) for key, value in self.arguments.items()}
            return str(evaluate(rest, Scope(self.names, {"true": True, "false": False, **arguments}), self.budget))
        if name not in self._commands:
            raise UnknownName.among("command", f"$({name})", (f"$({each})" for each in (*self._commands, "eval")))
        try:
            return self._commands[name](*rest.split())
        except TypeError as error:
            raise InvalidValue(f"$({text}) has too few or too many arguments") from error

    def _argument(self, name: str) -> str:
        if name not in self.arguments:
            raise UnknownName.among("argument", name, self.arguments)
        return self.arguments[name]


def _environment(name: str) -> str:
    if name not in os.environ:
        raise InvalidValue(f"$(env {name}): there is no such variable in the environment")
    return os.environ[name]
