# SPDX-License-Identifier: Apache-2.0
"""Shell completion of commands, options and words. bash: one file for all programs, which zsh reads after bashcompinit.
fish: one file each."""

BASH = """# SPDX-License-Identifier: Apache-2.0
# Completion for bash; for zsh after `autoload -U bashcompinit && bashcompinit`.
_ibr_options() {{
  case "$1" in
{options}
  esac
}}
_ibr_words() {{
  case "$1" in
{words}
  esac
}}
_ibr_commands() {{
  case "$1" in
{commands}
  esac
}}
_ibr() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} line=${{COMP_WORDS[0]##*/}} i words
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case " $(_ibr_commands "$line") " in
      *" ${{COMP_WORDS[i]}} "*) line="$line ${{COMP_WORDS[i]}}" ;;
      *) break ;;
    esac
  done
  words=$(_ibr_words "$line $prev")
  if [[ -z $words && $cur == -* ]]; then
    words=$(_ibr_options "$line")
  elif [[ -z $words && $i -eq $COMP_CWORD ]]; then
    words=$(_ibr_commands "$line")
  fi
  if [[ -n $words ]]; then
    # shellcheck disable=SC2207 # words without spaces
    COMPREPLY=($(compgen -W "$words" -- "$cur"))
  fi
}}
complete -o default -F _ibr {programs}
"""


def commands_of(program):
    """Returns the words that may follow each beginning of a command line."""
    after = {}
    for command in program.commands:
        line = program.name
        for word in command.words.split():
            words = after.setdefault(line, [])
            if word not in words:
                words.append(word)
            line += f" {word}"
    return after


def case(pattern, words):
    return f'    "{pattern}") echo "{" ".join(words)}" ;;'


def bash(programs):
    options, words, commands = [], [], []
    for program in programs:
        for line, following in commands_of(program).items():
            commands.append(case(line, following))
        for command in program.commands:
            named = [option for option in command.options if not option.argument]
            options.append(case(command.line, [name for option in named for name in option.names]))
            for option in named:
                if option.choices:
                    patterns = '" | "'.join(f"{command.line} {name}" for name in option.names)
                    words.append(case(patterns, option.choices))
    return BASH.format(options="\n".join(options), words="\n".join(words), commands="\n".join(commands),
                       programs=" ".join(program.name for program in programs))


def quoted(text):
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def first_sentence(text):
    return text.partition("; ")[0].partition(". ")[0]


def fish(program):
    lines = ["# SPDX-License-Identifier: Apache-2.0", f"# Completion of {program.name} for fish."]
    summaries = {command.line: command.summary for command in program.commands}

    def complete(conditions, arguments, description):
        line = f"complete -c {program.name}"
        if conditions:
            line += f" -n {quoted('; and '.join(conditions))}"
        lines.append(f"{line} {arguments}" + (f" -d {quoted(description)}" if description else ""))

    def seen(line):
        return [f"__fish_seen_subcommand_from {word}" for word in line.split()[1:]]

    for line, words in commands_of(program).items():
        for word in words:
            complete([*seen(line), f"not __fish_seen_subcommand_from {' '.join(words)}"], f"-f -a {word}",
                     summaries.get(f"{line} {word}", ""))
    for command in program.commands:
        for option in command.options:
            if option.argument:
                continue
            names = " ".join(f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}" for name in option.names)
            value = f" -x -a {quoted(' '.join(option.choices))}" if option.choices else "" if option.flag else " -r"
            complete(seen(command.line), names + value, first_sentence(option.description))
    return "\n".join(lines) + "\n"
