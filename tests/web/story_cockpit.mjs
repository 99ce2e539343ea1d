// The pages inside Debian's Cockpit, which asks the daemon over the bus in the place of isotherm-web.
import { eventually, expect, expectEqual, pause, Skip, step } from './check.mjs';
import { fillAll, find, press, seesAlert, seesText, textOf } from './browser.mjs';
import { Cockpit, PAGE, installPage, missing } from './cockpit_rig.mjs';
import { choose } from './story_enrol.mjs';
import { goTo } from './story_login.mjs';
import { examineAll, pagesOf } from './story_pages.mjs';

const [CONSENT, TURNED, BEGIN] = [/consents/i, /turned to the sides/i, /^begin$/i];

// The daemon's state and log, without a page.
const mode = (run) => JSON.parse(run.rig.isotherm('status', '--json').stdout).mode;
const records = (run) => JSON.parse(run.rig.isotherm('log', '--json', '--count', '300').stdout).records;
const last = (run, event) => records(run).filter((record) => record.event === event).at(-1);

const watches = (run, what, limitMs) => eventually(what, () => mode(run) === 'watch', limitMs);

async function opens(run) {
  const page = await run.cockpitBrowser.open({ path: PAGE });
  run.cockpitPage = page;
  await find(page, 'navigation', undefined, 20000);
  await seesText(page, /the door is locked/i);
  run.rig.show('none-back1');
  await eventually('a hint about the person at the door', async () => !/nobody is there|shows nothing/i.test(await page.$eval('.live', (part) => part.innerText)));
  run.rig.show();
  await seesText(page, /nobody is there/i);
  const names = (await pagesOf(page)).map((one) => one.name).join();
  expectEqual(names, 'Door,People,Enrol,Policy,Events,Health,Settings', 'the pages of root in Cockpit');
}

async function begins(page, name) {
  await goTo(page, /^people$/i);
  await goTo(page, /^enrol$/i);
  await fillAll(page, [[/^name$/i, name]]);
  await choose(page, 'checkbox', CONSENT, true);
  await choose(page, 'checkbox', TURNED, false);
  await press(page, 'button', BEGIN);
}

async function enrols(run) {
  const page = run.cockpitPage;
  run.rig.isotherm('remove', 'p01');
  await goTo(page, /^people$/i);
  await eventually('a list without p01', async () => !/\bp01\b/.test(await textOf(page)));
  await begins(page, 'p01');
  await find(page, 'button', /^stop the enrolment/i);
  await run.shoot(page, 'cockpit-enrol');
  run.rig.show('p01-enrol');
  await seesText(page, /the person is enrolled/i, 30000);
  run.rig.show();
  await watches(run, 'the door is watched after the enrolment');
  await goTo(page, /^people$/i);
  await seesText(page, /\bp01\b/);
  const act = last(run, 'act');
  expect(act.person === 'p01' && /^consent, asked by root of user 0$/.test(act.note), `a record of the consent of p01 was expected: ${JSON.stringify(act)}`);
}

async function visitAndLockdown(run) {
  const page = run.cockpitPage;
  await goTo(page, /^door$/i);
  const rows = () => page.$$eval('main tbody tr', (all) => all.filter((row) => /p01/.test(row.innerText)).length);
  const count = () => records(run).filter((record) => record.event === 'visit' && record.person === 'p01').length;
  await pause(1000); // until the page has read the earlier visits
  const [before, beforeLog] = [await rows(), count()];
  run.rig.show('p01-v1');
  await eventually('a visit of p01 on Door', async () => (await rows()) > before, 20000);
  run.rig.show();
  await pause(2500);
  expectEqual((await rows()) - before, count() - beforeLog, 'the new visits of p01 on Door, as in the log');
  await press(page, 'button', /^begin lockdown…$/i);
  await press(page, 'button', /^begin lockdown$/i);
  await seesText(page, /lockdown: nobody is let in/i);
  expectEqual(JSON.parse(run.rig.isotherm('status', '--json').stdout).lockdown, true, 'the lockdown of the daemon');
  await press(page, 'button', /^end lockdown…$/i);
  await press(page, 'button', /^end lockdown$/i);
  await eventually('no banner of the lockdown', async () => !/nobody is let in/.test(await textOf(page)), 3000);
  await eventually('the lockdown has ended', () => JSON.parse(run.rig.isotherm('status', '--json').stdout).lockdown === false);
  await goTo(page, /^events$/i);
  await seesText(page, /lockdown/i);
  await press(page, 'button', /^verify/i);
  await seesText(page, /are complete and unchanged/i, 20000);
  await press(page, 'button', /^close$/i);
}

async function everyPage(run) {
  for (const { name, href } of await pagesOf(run.cockpitPage)) {
    await step(`in Cockpit, the page ${name}: pictures, and the rules of accessibility in both themes and sizes`, async () => {
      const page = run.cockpitPage;
      await page.goto(href);
      await find(page, 'heading', undefined);
      await pause(1500); // what comes by the bus
      expectEqual((await page.$$eval('[role=alert]', (all) => all.map((one) => one.innerText.trim()).join(''))), '', `the alerts of ${name}`);
      if (/health/i.test(name)) {
        await seesText(page, /✓\s*good/i); // the findings, in the words of the page
      }
      await examineAll(run, page, `cockpit-${name.toLowerCase()}`);
    });
  }
}

// Another window of the same login stays open: its bridge, and with it the connection that Cockpit shares, lives on.
async function away(run, leave) {
  const page = await run.cockpitBrowser.open({ path: PAGE });
  await find(page, 'navigation', undefined, 20000);
  await begins(page, 'nobody');
  await eventually('the enrolment goes on', () => mode(run) === 'enroll');
  await leave(page);
  await watches(run, 'the door is watched again', 5000);
  await run.cockpitPage.bringToFront();
  await goTo(run.cockpitPage, /^people$/i);
  await seesText(run.cockpitPage, /people: \d/i); // the other window has kept its own connection
}

async function crashes(page) {
  const session = await page.createCDPSession();
  session.send('Page.crash').catch(() => undefined); // a page that crashes does not answer
  await pause(500);
  page.close().catch(() => undefined);
}

async function daemonGone(run) {
  const page = run.cockpitPage;
  await goTo(page, /^door$/i);
  await run.rig.stopDaemon();
  const late = await run.cockpitBrowser.open({ path: PAGE, context: page.context });
  await seesText(late, /does not run/i, 20000);
  await page.bringToFront();
  await seesText(page, /does not run/i, 20000);
  await run.rig.startDaemon();
  await seesText(page, /the door is locked/i, 30000);
  await late.bringToFront();
  await seesText(late, /the door is locked/i, 30000);
  await late.close();
  await page.bringToFront();
}

// Nobody's rights, in one group of the bus.
async function as(run, group, check) {
  const cockpit = await new Cockpit(run.rig, { data: run.cockpitData, group }).start();
  const browser = await cockpit.browser();
  try {
    await check(await browser.open({ path: PAGE }));
  } finally {
    await browser.stop();
    await cockpit.stop();
  }
}

async function withoutRights(run, page) {
  await seesAlert(page, /isotherm-observe/, 20000);
  expect(!(await page.$('nav')), 'no navigation was expected for a user without rights');
  await run.shoot(page, 'cockpit-no-rights');
}

async function enroller(run, page) {
  await find(page, 'navigation', undefined, 20000);
  expectEqual((await pagesOf(page)).map((one) => one.name).join(), 'Door,People,Enrol,Health', 'the pages of an enroller in Cockpit');
  await begins(page, 'p02');
  await eventually('the enrolment goes on', () => mode(run) === 'enroll');
  const act = last(run, 'act');
  expect(act.person === 'p02' && act.note === 'consent, asked by user 65534', `a record of the consent of p02 was expected: ${JSON.stringify(act)}`);
  await press(page, 'button', /^stop the enrolment…$/i);
  await press(page, 'button', /^stop the enrolment$/i);
  await watches(run, 'the door is watched after the enrolment was stopped');
}

export async function cockpit(run) {
  let ready = false;
  await step('the page is installed, and opens in Cockpit: Door shows state and hints', async () => {
    if (missing()) {
      throw new Skip(missing());
    }
    run.cockpitData = installPage(run.rig);
    run.cockpit = await new Cockpit(run.rig, { data: run.cockpitData }).start();
    run.cockpitBrowser = await run.cockpit.browser();
    await opens(run);
    ready = true;
  }, { always: true });
  if (!ready) {
    return;
  }
  await step('in Cockpit: p01 is enrolled, with a record of the consent', () => enrols(run));
  await step('in Cockpit: a visit is seen live, lockdown and release, the log is read and verified', () => visitAndLockdown(run));
  await everyPage(run);
  await step('in Cockpit: an enrolment whose page is closed ends, and the camera is free', () => away(run, (page) => page.close()));
  await step('in Cockpit: an enrolment whose page crashes ends, and the camera is free', () => away(run, crashes));
  await step('in Cockpit: the daemon ends and starts again: pages recover, also one that was opened meanwhile', () => daemonGone(run));
  await step('in Cockpit: a user without rights reads a sentence that helps', () => as(run, '', (page) => withoutRights(run, page)));
  await step('in Cockpit: an enroller enrols, and the daemon records the consent', () => as(run, run.rig.groups['isotherm-enroll'], (page) => enroller(run, page)));
  await step('in Cockpit: no request elsewhere, no violation of its content security policy, no exception', () => {
    for (const what of ['foreign', 'violations', 'faults']) {
      expectEqual(run.rig.cockpitBrowsers.flatMap((browser) => browser[what]).join('\n'), '', what);
    }
    expect(run.cockpitBrowser.requests > 50, `more than 50 requests were expected, and ${run.cockpitBrowser.requests} were made`);
  });
  await run.cockpitBrowser.stop();
  await run.cockpit.stop();
}
