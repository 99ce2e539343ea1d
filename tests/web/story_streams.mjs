// Many viewers, some of which do not read: they must not slow down the others, the door, or cost much memory.
import { expect, median, pause, quantile, say, step } from './check.mjs';

const VIEWERS = 16;
const SLOW = 8; // of these, so many do not read
const MEMORY_KB = 12 * 1024;
const WATCH_MS = 6000;

// Splits the stream /outline into records, and notes how old each one is when it arrives: its time is that of the machine's monotonic
// clock, which process.hrtime reads, too.
function reader(ages) {
  let rest = Buffer.alloc(0);
  return (part) => {
    const now = process.hrtime.bigint();
    rest = Buffer.concat([rest, part]);
    while (rest.length >= 4 && rest.length >= 4 + rest.readUInt32LE(0)) {
      const record = rest.subarray(4, 4 + rest.readUInt32LE(0));
      expect(record[0] === 1 && record[1] === 1, 'a record of version 1 and of the kind outline was expected');
      ages.push(Number(now - record.readBigInt64LE(8)) / 1e6);
      rest = rest.subarray(4 + rest.readUInt32LE(0));
    }
  };
}

async function framesOfDaemon(run) {
  return (await run.admin.ask('GET', '/status')).body.status.frames;
}

// Watches for a while: {frames of the daemon a second, records a second, ages}
async function watch(run) {
  const ages = [];
  const stream = await run.admin.stream('/outline', reader(ages));
  await pause(500);
  ages.length = 0;
  const [start, before] = [Date.now(), await framesOfDaemon(run)];
  await pause(WATCH_MS);
  const seconds = (Date.now() - start) / 1000;
  const frames = (await framesOfDaemon(run)) - before;
  stream.close();
  expect(ages.length > 0, 'a viewer was expected to get records of /outline while frames come');
  return { rate: frames / seconds, records: ages.length / seconds, median: median(ages), p95: quantile(ages, 0.95) };
}

const told = (what, found) => `${what}: the daemon examines ${found.rate.toFixed(1)} frames/s; a viewer gets ${found.records.toFixed(1)} records/s, `
  + `${found.median.toFixed(1)} ms after the frame (median), ${found.p95.toFixed(1)} ms (95 %)`;

export async function streams(run) {
  await step(`${VIEWERS} viewers, ${SLOW} of them too slow, hold back nobody`, async () => {
    await run.browser.closeAllBut(); // the server allows so many connections from one address
    const alone = await watch(run);
    const open = [];
    for (let i = 0; i < VIEWERS; i++) {
      open.push(await run.admin.stream('/outline', i < SLOW ? undefined : () => undefined));
    }
    try {
      const crowded = await watch(run);
      say(`         ${told('one viewer', alone)}`);
      say(`         ${told(`${VIEWERS + 1} viewers`, crowded)}`);
      expect(crowded.rate * 10 > alone.rate, 'the frame rate of the daemon was expected not to fall to a tenth');
      expect(crowded.records * 10 > alone.records, 'the records of a viewer that reads were expected not to fall to a tenth');
      expect(crowded.median < 10 * Math.max(alone.median, 20), 'a viewer that reads was expected to get its records about as soon as before');
      const answer = await run.admin.ask('GET', '/people');
      expect(answer.status === 200, 'GET /people was expected to be answered meanwhile');
      const { rss, pss, anonymous } = run.rig.memory();
      say(`         memory of isotherm-web with ${VIEWERS} viewers: ${(pss / 1024).toFixed(1)} MB of its own (PSS), ${(rss / 1024).toFixed(1)} MB resident with `
        + `shared libraries (RSS), ${(anonymous / 1024).toFixed(1)} MB of data`);
      expect(pss <= MEMORY_KB, `at most ${MEMORY_KB / 1024} MB (PSS) were expected with ${VIEWERS} viewers, and ${(pss / 1024).toFixed(1)} MB are used`);
    } finally {
      open.forEach((stream) => stream.close());
    }
  });
  await step('a viewer that has been slow for long gets no old records', async () => {
    const fresh = []; // of a viewer that reads at once: how late the daemon itself is on this machine
    const quick = await run.admin.stream('/outline', reader(fresh));
    const slow = await run.admin.stream('/outline');
    await pause(3000);
    slow.close();
    const ages = [];
    const stream = await run.admin.stream('/outline', reader(ages));
    await pause(1500);
    stream.close();
    quick.close();
    const oldest = Math.max(...fresh);
    expect(fresh.length > 0 && ages.length > 0 && ages[0] < oldest + 2000,
      `the first record was expected to be at most 2 s older than those of a quick viewer (${oldest} ms), and is ${ages[0]} ms old`);
  });
}
