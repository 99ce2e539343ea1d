// The whole run: starts the appliance, tells the story, and ends everything that it has started. run.sh starts it.
import { readdirSync, copyFileSync, mkdirSync } from 'node:fs';
import { request } from 'node:https';
import { spawnSync } from 'node:child_process';
import { join } from 'node:path';
import { Api } from './api.mjs';
import { begin, end, eventually, expect, expectEqual, onFailure, say, step } from './check.mjs';
import { Browser, slips } from './browser.mjs';
import { Rig, stop } from './rig.mjs';
import { access } from './story_access.mjs';
import { cockpit } from './story_cockpit.mjs';
import { crowd } from './story_crowd.mjs';
import { door } from './story_door.mjs';
import { enrol } from './story_enrol.mjs';
import { login, oldSession } from './story_login.mjs';
import { pages } from './story_pages.mjs';
import { people, removal } from './story_people.mjs';
import { policies } from './story_policy.mjs';
import { settingsInForce } from './story_settings.mjs';
import { streams } from './story_streams.mjs';
import { updates } from './story_update.mjs';

const here = (name) => process.env[`WEB_CHECK_${name}`];

class Run {
  constructor() {
    this.out = here('OUT');
    this.account = 'ada.admin';
    this.password = 'a long enough password';
    this.browsers = [];
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

// What the steps ask the API for, as the administrator of the run.
class Asks extends Run {
  async status() {
    return (await this.admin.ask('GET', '/status')).body.status;
  }

  async people() {
    const answer = await this.admin.ask('GET', '/people');
    expectEqual(answer.status, 200, 'GET /people');
    return answer.body.people;
  }

  async records() {
    const answer = await this.admin.ask('GET', '/log?from=1&max=1000');
    expectEqual(answer.status, 200, 'GET /log');
    return answer.body.records.map((record) => (typeof record === 'string' ? JSON.parse(record) : record));
  }

  // After a failure: nobody is before the camera, and no dialog of the step that failed is open.
  async beginAnew() {
    this.rig.show();
    await this.first?.goto(`${this.rig.base}/#door`);
    await this.first?.reload();
  }

  // A picture of a state of the story, whose texts are looked at, too.
  async shoot(page, name) {
    await page.screenshot({ path: join(this.out, `story-${name}.png`) });
    expectEqual((await slips(page)).join(), '', `values on the page ${name} that are no text`);
  }
}

// The screen's states are drawn by the program of its test.
function drawScreen(run) {
  const folder = join(here('SCRATCH'), 'screen');
  mkdirSync(folder);
  const drawn = spawnSync(join(run.rig.build, 'tests/enroll/test_screen_picture'), [folder], { encoding: 'utf8', cwd: run.rig.source });
  expectEqual(drawn.status, 0, 'the exit code of test_screen_picture');
  const files = readdirSync(folder).filter((file) => /^(en|de|ar)-.*-800\.png$/.test(file));
  expect(files.length >= 30, `pictures of ten states in three languages were expected, and ${files.length} were drawn`);
  for (const file of files) {
    copyFileSync(join(folder, file), join(run.out, `screen-${file}`));
  }
}

// What all browsers of the run have collected.
function collected(run, what) {
  return [run.browser, ...run.browsers].flatMap((browser) => browser[what]).join('\n');
}

function nothingFromElsewhere(run) {
  expect(run.browser.requests > 50, `more than 50 requests were expected in the run, and ${run.browser.requests} were made`);
  expectEqual(collected(run, 'foreign'), '', 'requests to other hosts in the whole run');
}

async function all(run) {
  const { rig } = run;
  await rig.startBus();
  rig.configure();
  rig.show();
  await rig.startDaemon();
  await rig.startWeb();
  run.browser = await new Browser({ base: rig.base, keyHash: rig.keyHash(), scratch: here('SCRATCH') }).start();
  onFailure((path) => run.browser.writeHelp(path));
  onFailure((path) => run.cockpitBrowser?.writeHelp(`${path}-cockpit`));
  onFailure(() => run.beginAnew());
  await login(run);
  run.admin = run.api();
  await run.admin.login(run.account, run.password);
  await access(run);
  await enrol(run);
  await door(run);
  await settingsInForce(run);
  await updates(run);
  await people(run);
  await policies(run);
  await pages(run);
  await cockpit(run);
  await removal(run);
  await oldSession(run);
  await crowd(run);
  await streams(run);
  await step('no page made a request to another host', () => nothingFromElsewhere(run));
  await step('no page violated the content security policy', () => expectEqual(collected(run, 'violations'), '', 'violations in the whole run'));
  await step('no script of a page ended with an exception', () => expectEqual(collected(run, 'faults'), '', 'exceptions in the whole run'));
  await step('the states of the screen are drawn', () => drawScreen(run));
  await step('isotherm-web ends when it is told to', async () => expectEqual(await rig.stopWeb(), 0, 'its exit code'));
}

const run = new Asks();
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
await run.cockpitBrowser?.stop().catch(() => undefined);
await run.cockpit?.stop();
await stop(run.rauc);
await run.rig.stop();
process.exit(code);
