// The whole run: starts the appliance, tells the story, and ends everything that it has started. run.sh starts it.
import { readdirSync, copyFileSync, mkdirSync } from 'node:fs';
import { request } from 'node:https';
import { spawnSync } from 'node:child_process';
import { join } from 'node:path';
import { Api } from './api.mjs';
import { begin, end, eventually, expect, expectEqual, onFailure, say, step } from './check.mjs';
import { Browser } from './browser.mjs';
import { Rig } from './rig.mjs';
import { access } from './story_access.mjs';
import { streams } from './story_streams.mjs';
import { crowd } from './story_crowd.mjs';

const here = (name) => process.env[`WEB_CHECK_${name}`];

class Run {
  constructor() {
    this.out = here('OUT');
    this.password = 'a long enough password';
    this.rig = new Rig({ source: here('SOURCE'), build: here('BUILD'), scratch: here('SCRATCH'), out: this.out });
  }

  // A client of the API without a login.
  api() {
    return new Api(this.rig.base, this.rig.certificate.toString());
  }

  // A file of the pages: {status, headers}. The path is sent as it is.
  page(path) {
    return new Promise((resolve, reject) => {
      const asked = request({ host: '127.0.0.1', port: this.rig.port, path, ca: this.rig.certificate.toString(), checkServerIdentity: () => undefined }, (answer) => {
        answer.resume();
        answer.on('end', () => resolve({ status: answer.statusCode, headers: answer.headers }));
      });
      asked.on('error', reject);
      asked.end();
    });
  }

  // Opens a stream, and returns a function that waits for its end.
  async streamEnd(client, path) {
    const stream = await client.stream(path, () => undefined);
    return (what) => eventually(what, () => stream.ended(), 15000);
  }
}

// The screen's states are drawn by the program of its test.
function drawScreen(run) {
  const folder = join(here('SCRATCH'), 'screen');
  mkdirSync(folder);
  const drawn = spawnSync(join(run.rig.build, 'tests/enroll/test_screen_picture'), [folder], { encoding: 'utf8', cwd: run.rig.source });
  expectEqual(drawn.status, 0, 'the exit code of test_screen_picture');
  const files = readdirSync(folder);
  expect(files.length > 5, `pictures of the states of the screen were expected, and ${files.length} were drawn`);
  for (const file of files) {
    copyFileSync(join(folder, file), join(run.out, `screen-${file}`));
  }
}

function nothingFromElsewhere(browser) {
  expect(browser.requests > 50, `more than 50 requests were expected in the run, and ${browser.requests} were made`);
  expectEqual(browser.foreign.join(' '), '', 'requests to other hosts in the whole run');
}

async function all(run) {
  const { rig } = run;
  await rig.startBus();
  rig.configure();
  await rig.startDaemon();
  await rig.startWeb();
  run.browser = await new Browser({ base: rig.base, keyHash: rig.keyHash(), scratch: here('SCRATCH') }).start();
  onFailure((path) => run.browser.writeHelp(path));
  await access(run);
  await crowd(run);
  await streams(run);
  await step('no page made a request to another host', () => nothingFromElsewhere(run.browser));
  await step('no page violated the content security policy', () => expectEqual(run.browser.violations.join('\n'), '', 'violations in the whole run'));
  await step('no script of a page ended with an exception', () => expectEqual(run.browser.faults.join('\n'), '', 'exceptions in the whole run'));
  await step('the states of the screen are drawn', () => drawScreen(run));
  await step('isotherm-web ends when it is told to', async () => expectEqual(await rig.stopWeb(), 0, 'its exit code'));
}

const run = new Run();
begin(run.out, here('STEPS'));
let code = 1;
try {
  await all(run);
  code = end();
} catch (fault) {
  say(`FAILED   the run could not go on: ${fault.stack}`);
  code = end() || 1;
}
await run.browser?.stop().catch(() => undefined);
await run.rig.stop();
process.exit(code);
