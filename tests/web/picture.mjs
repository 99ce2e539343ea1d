// Reads the PNG files that the browser makes of pages and of parts of them: 8 bits, colour with or without alpha, not interlaced.
import { inflateSync } from 'node:zlib';

function chunks(png) {
  const found = [];
  for (let at = 8; at + 8 <= png.length;) {
    const size = png.readUInt32BE(at);
    found.push({ kind: png.toString('latin1', at + 4, at + 8), bytes: png.subarray(at + 8, at + 8 + size) });
    at += 12 + size;
  }
  return found;
}

function paeth(a, b, c) {
  const p = a + b - c;
  const [da, db, dc] = [Math.abs(p - a), Math.abs(p - b), Math.abs(p - c)];
  if (da <= db && da <= dc) {
    return a;
  }
  return db <= dc ? b : c;
}

function unfilter(filter, left, above, corner) {
  return [0, left, above, (left + above) >> 1, paeth(left, above, corner)][filter];
}

// {width, height, step, bytes}: `step` bytes a point, row by row
export function decode(data) {
  const png = Buffer.from(data);
  const parts = chunks(png);
  const head = parts.find((part) => part.kind === 'IHDR').bytes;
  const [width, height] = [head.readUInt32BE(0), head.readUInt32BE(4)];
  if (head[8] !== 8 || ![2, 6].includes(head[9]) || head[12] !== 0) {
    throw new Error('a picture of a kind that the browser does not make');
  }
  const step = head[9] === 6 ? 4 : 3;
  const raw = inflateSync(Buffer.concat(parts.filter((part) => part.kind === 'IDAT').map((part) => part.bytes)));
  const row = width * step;
  const bytes = Buffer.alloc(row * height);
  for (let y = 0; y < height; y++) {
    const filter = raw[y * (row + 1)];
    for (let x = 0; x < row; x++) {
      const left = x >= step ? bytes[y * row + x - step] : 0;
      const above = y ? bytes[(y - 1) * row + x] : 0;
      const corner = y && x >= step ? bytes[(y - 1) * row + x - step] : 0;
      bytes[y * row + x] = raw[y * (row + 1) + 1 + x] + unfilter(filter, left, above, corner);
    }
  }
  return { width, height, step, bytes };
}

// The number of different colours.
export function colours(data) {
  const { step, bytes } = decode(data);
  const seen = new Set();
  for (let at = 0; at < bytes.length; at += step) {
    seen.add((bytes[at] << 16) | (bytes[at + 1] << 8) | bytes[at + 2]);
  }
  return seen.size;
}
