"""Files of every reader, mutated: read, or refused with a message, in little time and memory.

    python3 mutation_test.py PATH_TO_MOTTLE
"""

import re

import attack
import readers
from attack import demand, demand_an_answer, told

TOKENS = [b"1e400", b"1e308", b"-1e308", b"nan", b"inf", b"-inf", b"-1", b"0", b"4294967296", b"9223372036854775807", b"2147483647",
          b"-9223372036854775808", b"1e-320", b"99999999999999999999999999"]
SIGNS = [b'"', b"'", b"\\", b"{{", b"}}", b"[[", b"]]", b",", b"\0", b"\xff\xfe", b"\xe2\x80\xae", b"\r", b"\xef\xbb\xbf", b"(", b"*",
         b"#", b"=", b"\x1b[31m", b"../", b"\n"]
WORDS = [b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\0\0\0\x80", b"\0\0\0\0"]
NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")


def span(chance, size, longest):
    begin = chance.randrange(size + 1)
    return begin, min(size, begin + chance.randrange(1, longest))


def flip(chance, data):
    changed = bytearray(data)
    for _ in range(chance.choice([1, 1, 2, 8])):
        changed[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    return bytes(changed)


def cut(chance, data):
    return data[:chance.randrange(len(data))]


def leave_out(chance, data):
    begin, end = span(chance, len(data), 200)
    return data[:begin] + data[end:]


def repeat(chance, data):
    begin, end = span(chance, len(data), 400)
    return data[:end] + data[begin:end] + data[end:]


def replace_numbers(chance, data):
    for _ in range(chance.choice([1, 1, 3])):
        found = list(NUMBER.finditer(data))
        if found:
            number = chance.choice(found)
            data = data[:number.start()] + chance.choice(TOKENS) + data[number.end():]
    return data


def insert_sign(chance, data):
    place = chance.randrange(len(data) + 1)
    return data[:place] + chance.choice(SIGNS) + data[place:]


def change_lines(chance, data):
    lines = data.split(b"\n")
    if chance.random() < 0.3:
        chance.shuffle(lines)
    else:
        lines.pop(chance.randrange(len(lines)))
    return b"\n".join(lines)


def change_line_ends(_, data):
    return data.replace(b"\n", b"\r\n")


def insert_much(chance, data):
    place = chance.randrange(len(data) + 1)
    return data[:place] + chance.choice([b"A", b" ", b"[", b"1", b"("]) * chance.choice([3000, 100000]) + data[place:]


def replace_word(chance, data):
    place = chance.randrange(max(1, len(data) - 4))
    return data[:place] + chance.choice(WORDS) + data[place + 4:]


MUTATIONS = [flip, cut, leave_out, repeat, replace_numbers, replace_numbers, insert_sign, change_lines, change_line_ends, insert_much,
             replace_word]
# A study may ask for what the machine does not have; then it is told so.
MAY_ASK_FOR_MEMORY = {"study"}


class Mutations(attack.Family):
    """A mutation a file, all readers in turn."""

    title = "mutated inputs of every reader"
    few = 88
    many = None
    minutes = 60
    seconds = 20

    def prepare(self):
        self.seeds = readers.seeds(self)
        self.readers = sorted(self.seeds)

    def lay_out(self, seed, content):
        for path in list(self.folder.iterdir()):
            self.remove(path.name)
        if seed.study:
            self.write("study.toml", seed.study)
        for name, text in seed.beside:
            self.write(name, text)
        self.write(seed.name, content)

    def attack(self, chance, number):
        reader = self.readers[number % len(self.readers)]
        seed = chance.choice(self.seeds[reader])
        content = seed.content
        mutations = chance.choices(MUTATIONS, k=chance.choice([1, 1, 1, 2, 4]))
        for mutation in mutations:
            content = mutation(chance, content) if content else content
        self.doing = f"{reader}, {seed.name}: {', '.join(mutation.__name__ for mutation in mutations)}"
        self.lay_out(seed, content)
        ended = self.call(*seed.arguments)
        demand_an_answer(ended)
        demand(reader in MAY_ASK_FOR_MEMORY or "memory does not suffice" not in ended.err, f"asked for too much: {told(ended)}")


class Untouched(Mutations):
    """The same files as they are: read as they must be, or a mutation would tell nothing."""

    title = "the files that are mutated, as they are"

    def prepare(self):
        super().prepare()
        self.all = [seed for reader in self.readers for seed in self.seeds[reader]]
        self.few = len(self.all)

    def attack(self, chance, number):
        seed = self.all[number]
        self.doing = f"{seed.reader}, {seed.name}"
        self.lay_out(seed, seed.content)
        ended = self.call(*seed.arguments)
        demand_an_answer(ended)
        demand(seed.code in (-1, ended.code), f"ended with {ended.code}, not {seed.code}: {told(ended)}")


class MutationTest(attack.AttackTest):
    def test_what_is_mutated_is_read(self):
        self.survive(Untouched)

    def test_mutated_files_are_read_or_refused(self):
        self.survive(Mutations)


if __name__ == "__main__":
    attack.main()
