#!/usr/bin/env python3
"""Puts a fault into the image of a machine's disk, to try check_disk.sh: spoil_disk.py KIND DISK PARTITIONS NAME

PARTITIONS has a line "NAME START SIZE" for each partition, in sectors. NAME is a kernel image in EFI/Linux of the partition esp, or a partition.

  alias    a second name of the kernel image, with the same clusters
  hole     a cluster in the middle of the kernel image is free, as in one that is half deleted
  byte     a byte in the middle of the kernel image is another one
  begin    its first sector has zeros only
  root     a byte in the middle of the partition is another one
"""
import struct
import sys

SECTOR = 512
ENTRY = 32
END_OF_CHAIN = 0x0ffffff8
LONG_NAME = 0x0f


class Fat:
    """A FAT32 file system within a disk (Microsoft, FAT32 File System Specification, 2000)."""

    def __init__(self, disk, start):
        self.disk, self.start = disk, start
        boot = self.read(0, SECTOR)
        self.cluster_size = boot[13] * SECTOR
        reserved, self.tables = struct.unpack_from('<H', boot, 14)[0], boot[16]
        self.table_size, self.root = struct.unpack_from('<I', boot, 36)[0] * SECTOR, struct.unpack_from('<I', boot, 44)[0]
        self.table, self.data = reserved * SECTOR, reserved * SECTOR + self.tables * self.table_size

    def read(self, place, size):
        self.disk.seek(self.start + place)
        return self.disk.read(size)

    def write(self, place, data):
        self.disk.seek(self.start + place)
        self.disk.write(data)

    def chain(self, cluster):
        while 2 <= cluster < END_OF_CHAIN:
            yield cluster
            cluster = struct.unpack('<I', self.read(self.table + 4 * cluster, 4))[0] & 0x0fffffff

    def place(self, cluster):
        return self.data + (cluster - 2) * self.cluster_size

    def entries(self, cluster):
        """Yields the place and the bytes of each entry of a directory, also of free ones, and the long name before it."""
        name = ''
        for part in self.chain(cluster):
            for place in range(self.place(part), self.place(part) + self.cluster_size, ENTRY):
                entry = self.read(place, ENTRY)
                if entry[11] == LONG_NAME and entry[0] not in (0, 0xe5):
                    name = (entry[1:11] + entry[14:26] + entry[28:32]).decode('utf-16-le').split('\0')[0] + name
                    continue
                yield place, entry, name or entry[:11].decode('latin-1').replace(' ', '')
                name = ''

    def find(self, cluster, name):
        for place, entry, its_name in self.entries(cluster):
            if entry[0] not in (0, 0xe5) and its_name.lower() == name.lower():
                return place, entry, struct.unpack_from('<H', entry, 20)[0] << 16 | struct.unpack_from('<H', entry, 26)[0]
        sys.exit(f'spoil_disk.py: there is no {name}')


def partition(path, name):
    with open(path, encoding='ascii') as lines:
        for line in lines:
            label, start, size = line.split()
            if label == name:
                return int(start) * SECTOR, int(size) * SECTOR
    return sys.exit(f'spoil_disk.py: there is no partition {name}')


def change_byte(disk, place):
    disk.seek(place)
    byte = disk.read(1)[0]
    disk.seek(place)
    disk.write(bytes([byte ^ 1]))


def spoil_file(fat, kind, name):
    folder = fat.find(fat.find(fat.root, 'EFI')[2], 'Linux')[2]
    _, entry, first = fat.find(folder, name)
    clusters = list(fat.chain(first))
    middle = clusters[len(clusters) // 2]
    if kind == 'alias':
        free = next(place for place, other, _ in fat.entries(folder) if other[0] in (0, 0xe5))
        fat.write(free, b'SECOND  NEW' + entry[11:])
    elif kind == 'hole':
        for table in range(fat.tables):
            fat.write(fat.table + table * fat.table_size + 4 * middle, bytes(4))
    elif kind == 'byte':
        change_byte(fat.disk, fat.start + fat.place(middle))
    elif kind == 'begin':
        fat.write(fat.place(first), bytes(SECTOR))
    else:
        sys.exit(f'spoil_disk.py: there is no kind {kind}')


def main():
    kind, path, partitions, name = sys.argv[1:]
    with open(path, 'r+b') as disk:
        if kind == 'root':
            start, size = partition(partitions, name)
            change_byte(disk, start + 4096 * (size // 4096 // 4))
        else:
            spoil_file(Fat(disk, partition(partitions, 'esp')[0]), kind, name)


main()
