"""The mutations of mutate.py: what is changed in a line, and what is left alone."""
import re

# Token for token: what stands between spaces is a binary operator in this code.
SWAPS = [(" + ", " - "), (" - ", " + "), (" * ", " / "), (" / ", " * "), (" += ", " -= "), (" -= ", " += "),
         (" *= ", " /= "), (" < ", " <= "), (" <= ", " < "), (" > ", " >= "), (" >= ", " > "), (" == ", " != "),
         (" != ", " == "), (" && ", " || "), (" || ", " && "), ("std::max", "std::min"), ("std::min", "std::max"),
         (".begin()", ".end()"), (".end()", ".begin()"), ("add_scaled(", "subtract_scaled("),
         ("subtract_scaled(", "add_scaled("), ("add_outer(", "subtract_outer("), ("subtract_outer(", "add_outer("),
         ("transposed(", "("), (".transpose()", "")]
# Names that are easily taken for each other.
NAMES = [("i", "j"), ("r", "q"), ("c", "d"), ("k", "l"), ("a", "b"), ("x", "y"), ("wk", "wl"), ("begin", "end"),
         ("row", "rows"), ("n", "m"), ("n", "q"), ("r1", "r2"), ("d_nu", "nu"), ("d_lambda", "lambda"), ("f", "u"),
         ("inertia_", "inertia0_"), ("joint_k_", "joint_k0_"), ("first_column", "first_member"), ("body", "step"),
         ("factor_", "factor_M_")]
STATEMENT = re.compile(r"^(?:(?:if|for|else|while) ?\(.*?\) (?=\S))?(?:\+\+|--|\*)?[a-zA-Z_][\w.\->:\[\]+* /]*(?:\(.*\)|<[^;]*>\(.*\)| [-+*/]?= .*|\+\+|--)?;$")
DECLARATION = re.compile(r"^(?:const|auto|using|return|break|continue|static|constexpr|template|std::vector|std::set|int|Index|"
                         r"double|bool|T|V|W|Six<|Report|Plan|Blocks|Buffers|Neighbours|Cliques|const_cast|struct|class|virtual|"
                         r"VectorX|MatrixX|Workspace|public|private|Tree)\b")


def without_comments(line):
    code = re.sub(r'"(?:\\.|[^"\\])*"', lambda m: '"' + " " * (len(m.group()) - 2) + '"', line)
    at = code.find("//")
    return code if at < 0 else code[:at]


def arguments(code, at):
    """Spans of the arguments of the call whose parenthesis opens at `at`; None when it does not close on this line."""
    depth, start, spans = 0, at + 1, []
    for k in range(at, len(code)):
        if code[k] in "([{":
            depth += 1
        elif code[k] in ")]}":
            depth -= 1
            if depth == 0:
                return spans + [(start, k)]
        elif code[k] == "," and depth == 1:
            spans.append((start, k))
            start = k + 1
    return None


def mutants_of_line(line, known):
    """(kind, mutated line), each once. `known`: identifiers of the function around it."""
    code = without_comments(line)
    head = len(code) - len(code.lstrip())

    def put(begin, end, text):
        return line[:begin] + text + line[end:]

    for old, new in SWAPS:
        for m in re.finditer(re.escape(old), code):
            if old.endswith("(") and m.start() and (code[m.start() - 1].isalnum() or code[m.start() - 1] == "_"):
                continue
            yield "operator", put(m.start(), m.end(), new)
    for m in re.finditer(r"(?<![\w.])\d+(?![\w.])", code):
        yield "constant", put(m.start(), m.end(), "0" if m.group() == "1" else str(int(m.group()) + 1))
    for m in re.finditer(r"(?<=[(=,\[] )-(?=[\w(])|(?<=[(\[])-(?=[\w(])", code):
        if code[m.start() + 1:m.start() + 2] not in "01":
            yield "sign", put(m.start(), m.end(), "")
    for m in re.finditer(r"\[(\w+)\]", code):
        if not m.group(1).isdigit():
            yield "index", put(m.start(), m.end(), "[" + m.group(1) + " + 1]")
    for left, right in NAMES:
        for old, new in ((left, right), (right, left)):
            if new not in known:
                continue
            for m in re.finditer(r"\b" + old + r"\b", code):
                yield "name", put(m.start(), m.end(), new)
    for m in re.finditer(r"\b(?:add_outer|subtract_outer|subtract_schur|dot|multiply|push_back|insert|erase|swap)\(", code):
        spans = arguments(code, m.end() - 1)
        if spans and len(spans) >= 2:
            (a, b), (c, d) = spans[-2], spans[-1]
            yield "arguments", line[:a] + line[c:d].rjust(1) + line[b:c] + line[a:b] + line[d:]
    for m in re.finditer(r"\bif \(", code):
        spans = arguments(code, m.end() - 1)
        if spans:
            for value in ("true", "false"):
                yield "condition", put(spans[0][0], spans[-1][1], value)
    bare = code.strip()
    if STATEMENT.match(bare) and not DECLARATION.match(bare):
        start = head
        control = re.match(r"(?:if|for|while) ", bare)
        if control:
            spans = arguments(code, code.index("(", head))
            if not spans or code[spans[-1][1] + 1:].strip() == ";":
                return
            start = spans[-1][1] + 2
        yield "statement", line[:start] + ";"


def names_around(lines):
    """Per line the identifiers of the function it belongs to: functions end with a brace in the first column."""
    out, start = [], 0
    for number, line in enumerate(lines):
        if line.startswith("}") or number == len(lines) - 1:
            names = set(re.findall(r"\w+", " ".join(without_comments(x) for x in lines[start:number + 1])))
            out += [names] * (number + 1 - start)
            start = number + 1
    return out


def mutants(name, text):
    """Every mutant of a file as a dictionary. bytes() is an estimate for tables and is left out."""
    lines = text.split("\n")
    known, skipped, out = names_around(lines), False, []
    for number, line in enumerate(lines):
        if re.search(r"\b(?:do_)?bytes\(\) const", line):
            skipped = True
        code = without_comments(line)
        if not skipped and code.strip() and not code.lstrip().startswith(("#", "template <class", "using", "namespace", "}  //", "\\")) \
                and "DELASSUS_INSTANTIATE" not in code:
            seen = {line.strip()}
            for kind, changed in mutants_of_line(line, known[number]):
                if changed.strip() in seen:
                    continue
                seen.add(changed.strip())
                out.append({"file": name, "line": number + 1, "kind": kind, "before": line.strip(), "after": changed.strip(),
                            "text": changed})
        if skipped and (line.startswith("}") or re.search(r"\{.*\}$", line)):
            skipped = False
    return out
