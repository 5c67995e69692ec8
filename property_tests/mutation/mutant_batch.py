"""Many mutants of one C++ file in one program: every function's body becomes a switch over the number of the mutant.

    int f(int x) {                 int f(int x) { switch (delassus_mutant) {
      return x + 1;       →          case 1: { return x - 1; } break;
    }                                default: { return x + 1; }
                                   }}
The int `delassus_mutant` is the program's. A mutant changes a body and nothing else; constexpr functions become inline ones.
"""
import re


def masked(text):
    """The text with comments, literals and preprocessor lines blanked, of the same length."""
    blank = lambda m: re.sub(r"[^\n]", " ", m.group())
    return re.sub(r'//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*', blank, text, flags=re.M)


def bodies(text):
    """Spans of the bodies of functions: from behind the opening to the closing brace."""
    code, stack, start, found = masked(text), [], 0, []
    for at, char in enumerate(code):
        if char == "{":
            head, inside = code[start:at], bool(stack) and stack[-1][0] != "scope"
            kind = "scope" if re.search(r"\b(?:namespace|class|struct|extern)\b[^()]*$", head) else "block"
            if not inside and re.search(r"\)\s*(?:const\s*)?(?:noexcept\s*)?(?:->[^=]*|:[^=]*)?$", head) and " = " not in head:
                kind = "function"
            stack.append(("block" if inside else kind, at + 1))
        elif char == "}" and stack:
            kind, begin = stack.pop()
            if kind == "function":
                found.append((begin, at))
        if char in "{};" :
            start = at + 1
    return found


def place(text, spans, mutant):
    """(index of the body a mutant changes, the body changed), or None when it changes more."""
    lines = text.split("\n")
    before, after = lines[mutant["line"] - 1], mutant["text"]
    common = 0
    while common < min(len(before), len(after)) and before[common] == after[common]:
        common += 1
    tail = 0
    while tail < min(len(before), len(after)) - common and before[-1 - tail] == after[-1 - tail]:
        tail += 1
    line = sum(len(x) + 1 for x in lines[:mutant["line"] - 1])
    for index, (begin, end) in enumerate(spans):
        if begin <= line + common and line + len(before) - tail <= end:
            changed = text[:line] + after + text[line + len(before):]
            return index, changed[begin:end + len(after) - len(before)]
    return None


def compose(name, text, mutants, first=1):
    """The file with mutants `first`, `first` + 1, …, each of which `place` has found a body for."""
    spans, cases = bodies(text), {}
    for number, mutant in enumerate(mutants, first):
        index, body = place(text, spans, mutant)
        cases.setdefault(index, []).append('case %d: {\n#line 1 "mutant_%d"\n%s\n} break;\n' % (number, number, body))
    for index in sorted(cases, reverse=True):
        begin, end = spans[index]
        line, head = text.count("\n", 0, begin) + 1, max(text.rfind(c, 0, begin - 1) for c in "{};") + 1
        text = text[:head] + text[head:begin].replace("constexpr", "inline   ") + text[begin:]
        text = '%s\nswitch (delassus_mutant) {\n%sdefault: {\n#line %d "%s"\n%s}}%s' % (
            text[:begin], "".join(cases[index]), line, name, text[begin:end], text[end:])
    top = re.search(r"^(?!//|#pragma once)", text, flags=re.M).start()
    return text[:top] + "extern int delassus_mutant;\n" + text[top:]


def blamed(output):
    """Numbers of the mutants a compiler's errors come from: where the error is, or what was instantiated for it."""
    numbers, context = set(), None
    for line in output.split("\n"):
        found = re.search(r"\bmutant_(\d+):\d+", line)
        if "error:" in line:
            if line.startswith("mutant_"):
                context = found
            if context:
                numbers.add(int(context.group(1)))
            context = None
        elif "note:" in line:
            context = None
        elif found and not context:
            context = found
    return numbers
