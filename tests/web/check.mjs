// Runs the steps of the browser test one after another and counts them. A step is a function that throws if something is not as it
// should be; the message says what was expected. A step that fails does not end the run.
import { appendFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

export class Skip extends Error {}

const counts = { passed: 0, failed: 0, skipped: 0 };
const tidy = []; // called after a failure with the name of the step: they write what helps to understand it
let folder = '.';
let only = '';

// Results go into the folder `out`. `pattern` chooses steps by their names; the empty text chooses all of them.
export function begin(out, pattern = '') {
  folder = out;
  only = pattern;
  writeFileSync(join(folder, 'steps.txt'), '');
}

export function onFailure(write) {
  tidy.push(write);
}

export function say(text) {
  console.log(text);
  appendFileSync(join(folder, 'steps.txt'), `${text}\n`);
}

const LIMIT_MS = 180000; // of a step: a step that hangs is a failure, and the run goes on

function withLimit(promise, ms) {
  let timer;
  const limit = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error(`the step is not done after ${ms / 1000} s`)), ms);
  });
  return Promise.race([promise, limit]).finally(() => clearTimeout(timer));
}

// Returns whether the step has not failed.
export async function step(name, check, { always = false } = {}) {
  if (only && !always && !name.includes(only)) {
    return true;
  }
  const start = process.hrtime.bigint();
  const took = () => `${(Number(process.hrtime.bigint() - start) / 1e9).toFixed(1)} s`;
  try {
    await withLimit(Promise.resolve().then(check), LIMIT_MS);
    counts.passed++;
    say(`passed   ${name} (${took()})`);
    return true;
  } catch (fault) {
    if (fault instanceof Skip) {
      counts.skipped++;
      say(`skipped  ${name}: ${fault.message}`);
      return true;
    }
    counts.failed++;
    say(`FAILED   ${name} (${took()}): ${fault.message}`);
    if (process.env.WEB_CHECK_STACKS) {
      say(fault.stack);
    }
    await writeHelp(name);
    return false;
  }
}

// A step that the others need: it runs whatever steps were chosen, and its failure ends the run.
export async function need(name, check) {
  expect(await step(name, check, { always: true }), `without this the run cannot go on: ${name}`);
}

async function writeHelp(name) {
  const word = name.toLowerCase().replace(/[^a-z0-9]+/g, '-').slice(0, 60);
  for (const write of tidy) {
    try {
      await withLimit(write(join(folder, `failed-${word}`)), 20000);
    } catch (fault) {
      say(`         nothing more is known: ${fault.message}`);
    }
  }
}

export function expect(condition, message) {
  if (!condition) {
    throw new Error(message);
  }
}

export function expectEqual(found, expected, what) {
  expect(found === expected, `${what}: ${JSON.stringify(expected)} was expected, and ${JSON.stringify(found)} was found`);
}

export const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

// Asks until the answer is truthy, and returns it. `what` says what is waited for. An error of `ask` counts as "not yet".
export async function eventually(what, ask, limitMs = 15000) {
  const end = Date.now() + limitMs;
  let last = '';
  for (;;) {
    try {
      const answer = await ask();
      if (answer) {
        return answer;
      }
    } catch (fault) {
      last = fault.message;
    }
    expect(Date.now() < end, `expected within ${limitMs / 1000} s: ${what}${last ? ` (${last})` : ''}`);
    await pause(50);
  }
}

export function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)];
}

export function quantile(values, share) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(sorted.length * share))];
}

// Prints the last line. Returns the exit code.
export function end() {
  console.log(`${counts.passed} passed, ${counts.failed} failed, ${counts.skipped} skipped`);
  return counts.failed === 0 && counts.passed > 0 ? 0 : 1;
}
