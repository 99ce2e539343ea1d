// The whole run of the hub's pages: starts the hub, tells the story, and ends everything that it has started. run.sh starts it.
import { join } from 'node:path';
import { Api } from '../api.mjs';
import { begin, end, expect, expectEqual, onFailure, say, step } from '../check.mjs';
import { Browser, slips } from '../browser.mjs';
import { collectEnglish, everyPage, language } from '../story_pages.mjs';
import { HubRig } from './rig.mjs';
import { fleet } from './story_fleet.mjs';
import { roles, setup } from './story_accounts.mjs';

const here = (name) => process.env[`WEB_CHECK_${name}`];

class Run {
  constructor() {
    this.out = here('OUT');
    this.account = 'ada.admin';
    this.password = 'a long enough password';
    this.browsers = [];
    this.rig = new HubRig({ source: here('SOURCE'), build: here('BUILD'), scratch: here('SCRATCH'), out: this.out });
  }

  // A client of the API without a login.
  api() {
    return new Api(this.rig.base, this.rig.authority.toString());
  }

  // A picture of a state of the story, whose texts are looked at, too.
  async shoot(page, name) {
    await page.screenshot({ path: join(this.out, `story-${name}.png`) });
    expectEqual((await slips(page)).join(), '', `values on the page ${name} that are no text`);
  }

  collected(what) {
    return [this.browser, ...this.browsers].flatMap((browser) => browser[what]).join('\n');
  }
}

async function all(run) {
  const { rig } = run;
  await rig.startDatabase();
  await rig.startHub();
  rig.startDoors();
  run.browser = await new Browser({ base: rig.base, keyHash: rig.keyHash(), scratch: here('SCRATCH') }).start();
  onFailure((path) => run.browser.writeHelp(path));
  await setup(run);
  run.admin = run.api();
  await run.admin.login(run.account, run.password);
  await fleet(run);
  await roles(run);
  await everyPage(run);
  await step('the English texts of all pages are collected', () => collectEnglish(run));
  await step('German: every text is translated', () => language(run, 'de', 'ltr'));
  await step('Arabic: from right to left, every text is translated', () => language(run, 'ar', 'rtl'));
  await step('no page made a request to another host', () => {
    expect(run.browser.requests > 50, `more than 50 requests were expected in the run, and ${run.browser.requests} were made`);
    expectEqual(run.collected('foreign'), '', 'requests to other hosts in the whole run');
  });
  await step('no page violated the content security policy', () => expectEqual(run.collected('violations'), '', 'violations in the whole run'));
  await step('no script of a page ended with an exception', () => expectEqual(run.collected('faults'), '', 'exceptions in the whole run'));
  await step('isotherm-hub ends when it is told to', async () => expectEqual(await rig.stopWeb(), 0, 'its exit code'));
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
