// Writes a ZIP of files {path, bytes} (PKWARE's APPNOTE: local headers, central directory, end record).

const crcTable = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let bit = 0; bit < 8; ++bit) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n;
});

function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = crcTable[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

async function deflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Little-endian numbers: [value, bytes] each.
function record(...fields) {
  const out = [];
  for (const [value, size] of fields)
    for (let i = 0; i < size; ++i) out.push(Math.floor(value / 256 ** i) & 255);
  return Uint8Array.from(out);
}

const version = 20, utf8Names = 0x800, deflate = 8, firstOfJanuary1980 = 33;

const shared = (entry) => [[version, 2], [utf8Names, 2], [deflate, 2], [0, 2], [firstOfJanuary1980, 2],
  [entry.crc, 4], [entry.packed.length, 4], [entry.size, 4], [entry.name.length, 2], [0, 2]];

export async function zipOf(files) {
  const parts = [], central = [];
  let offset = 0;
  for (const { path, bytes } of files) {
    const entry = { name: new TextEncoder().encode(path), crc: crc32(bytes), size: bytes.length, packed: await deflated(bytes) };
    const local = record([0x04034b50, 4], ...shared(entry));
    parts.push(local, entry.name, entry.packed);
    central.push(record([0x02014b50, 4], [version, 2], ...shared(entry), [0, 2], [0, 2], [0, 2], [0, 4], [offset, 4]), entry.name);
    offset += local.length + entry.name.length + entry.packed.length;
  }
  const size = central.reduce((sum, part) => sum + part.length, 0);
  const end = record([0x06054b50, 4], [0, 2], [0, 2], [files.length, 2], [files.length, 2], [size, 4], [offset, 4], [0, 2]);
  return new Blob([...parts, ...central, end], { type: "application/zip" });
}
