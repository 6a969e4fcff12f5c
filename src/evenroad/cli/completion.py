"""Completion of the command in a shell: names of verbs, then those of a verb's options, else files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

_BASH = """\
_evenroad() {
    local word="${COMP_WORDS[COMP_CWORD]}" names=""
    if [ "$COMP_CWORD" -eq 1 ]; then
        names="@VERBS@"
    else
        case "${COMP_WORDS[COMP_CWORD-1]}" in
@VALUES@
        esac
        case "$word" in
            -*) case "${COMP_WORDS[1]}" in
@CASES@
                esac ;;
        esac
    fi
    COMPREPLY=($(compgen -W "$names" -- "$word"))
}
complete -o default -F _evenroad evenroad
"""
_ZSH = "#compdef evenroad\nautoload -U +X bashcompinit && bashcompinit\n"
SHELLS = ("bash", "fish", "zsh")


def completion(
    shell: str,
    verbs: Mapping[str, str],
    options: Mapping[str, Iterable[str]],
    values: Mapping[str, Sequence[str]],
) -> str:
    """Return the script for a shell, from the verbs with what they do, and the names of each one's options.

    `values` are the names that may follow a verb or an option.
    """
    if shell == "fish":
        lines = [
            "complete -c evenroad -n __fish_use_subcommand -a " + f"{verb} -d {_quoted(verbs[verb])}" for verb in verbs
        ]
        for verb, names in options.items():
            seen = f"complete -c evenroad -n '__fish_seen_subcommand_from {verb}'"
            lines += [f"{seen} -l {name.removeprefix('--')}" for name in sorted(names)]
        for before, names in values.items():
            seen = f"complete -c evenroad -n '__fish_prev_arg_in {before}'"
            lines.append(f"{seen} -a {_quoted(' '.join(names))}")
        return "\n".join(lines) + "\n"
    cases = [f"{' ' * 20}{verb}) names={_quoted(' '.join(sorted(names)))} ;;" for verb, names in options.items()]
    named = [f"{' ' * 12}{before}) names={_quoted(' '.join(names))} ;;" for before, names in values.items()]
    script = _BASH.replace("@VERBS@", " ".join(verbs)).replace("@CASES@", "\n".join(cases))
    script = script.replace("@VALUES@", "\n".join(named))
    return _ZSH + script if shell == "zsh" else script


def _quoted(text: str) -> str:
    """Return a text as one word of a shell."""
    return "'" + text.replace("'", r"'\''") + "'"
