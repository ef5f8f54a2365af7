"""Reads the file that `nearfield edit --ui-state` keeps: ui.py FILE get PATH | place WIDGET | wait 'PATH OP VALUE and ...'."""
import json
import operator
import re
import sys
import time


OPERATORS = {"==": operator.eq, "!=": operator.ne, "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}


def state(path):
    try:
        with open(path) as file:
            return json.load(file)
    except (OSError, ValueError):
        return {}


def find(value, path):
    """A path's parts are keys, which may hold dots: the longest that fits first."""
    if not path:
        return value
    if isinstance(value, list):
        head, _, rest = path.partition(".")
        return find(value[int(head)], rest) if int(head) < len(value) else None
    if not isinstance(value, dict):
        return None
    parts = path.split(".")
    for count in range(len(parts), 0, -1):
        key = ".".join(parts[:count])
        if key in value:
            found = find(value[key], ".".join(parts[count:]))
            if found is not None:
                return found
    return None


def literal(text):
    try:
        return json.loads(text)
    except ValueError:
        return text


def number(value):
    try:
        return float(value)
    except (TypeError, ValueError):
        return None


def holds(condition, document):
    for one in condition.split(" and "):
        match = re.fullmatch(r"\s*(\S+)\s*(==|!=|<=|>=|<|>)\s*(.+?)\s*", one)
        if not match:
            sys.exit(f"bad condition: {one}")
        path, op, text = match.groups()
        a, b = find(document, path), literal(text)
        if a is None:
            return False
        x, y = number(a), number(b)
        if x is not None and y is not None:
            a, b = x, y
        elif op not in ("==", "!="):
            return False
        if not OPERATORS[op](a, b):
            return False
    return True


def main():
    path, what, rest = sys.argv[1], sys.argv[2], sys.argv[3]
    if what == "get":
        print(find(state(path), rest))
    elif what == "place":
        for _ in range(200):
            widget = state(path).get("widgets", {}).get(rest)
            if widget and widget["visible"] and widget["enabled"]:
                x, y, width, height = widget["rect"]
                print(int(x + width / 2), int(y + height / 2))
                return
            time.sleep(0.05)
        sys.exit(f"there is no widget '{rest}' to be clicked")
    elif what == "wait":
        end = time.time() + 40
        while not holds(rest, state(path)):
            if time.time() > end:
                sys.exit(f"it did not come to this in time: {rest}")
            time.sleep(0.05)


main()
