// What happens at the door, seen live on the pages, and what closes it to everybody.
import { eventually, expect, expectEqual, pause, step } from './check.mjs';
import { find, press, seesText, textOf } from './browser.mjs';
import { goTo } from './story_login.mjs';

// What a page says at its top when something is out of the ordinary.
const banner = (page) => page.evaluate(() => document.querySelector('.banner').innerText.trim());

// Begins or ends the lockdown by the buttons of the page and of its question.
async function toggleLockdown(page, on) {
  await press(page, 'button', on ? /^begin lockdown…$/i : /^end lockdown…$/i);
  await find(page, 'dialog', /lockdown\?$/i);
  await press(page, 'button', on ? /^begin lockdown$/i : /^end lockdown$/i);
}

// How often a page shows a text.
const countOf = async (page, pattern) => ((await textOf(page)).match(new RegExp(pattern.source, `g${pattern.flags}`)) ?? []).length;

// Somebody comes, stays until both pages show it, and goes. `picture`: its name, if one is to be kept.
async function comes(run, recording, pattern, picture) {
  const [before, beforeDoor] = [await countOf(run.events, pattern), await countOf(run.first, pattern)];
  run.rig.show(recording);
  try {
    await eventually(`one more ${pattern} on Door`, async () => (await countOf(run.first, pattern)) > beforeDoor, 20000);
    if (picture) {
      await run.shoot(run.first, picture);
    }
    await eventually(`one more ${pattern} on Events`, async () => (await countOf(run.events, pattern)) > before, 20000);
  } finally {
    run.rig.show();
  }
  await pause(2500); // until the visit is over and the door is locked again
}

async function visitors(run) {
  run.events = await run.browser.open({ context: run.first.context });
  await goTo(run.events, /^events$/i);
  await goTo(run.first, /^door$/i);
  await comes(run, 'p01-v1', /p01/, 'door-visit');
  await run.shoot(run.events, 'events-live');
}

async function strangers(run) {
  await comes(run, 'x01-v1', /not recognised/i);
  const log = await run.records();
  const last = log.filter((record) => record.event === 'visit').at(-1);
  expectEqual(last.verdict, 'deny', 'the verdict about the stranger in the log');
}

async function lockdown(run) {
  await goTo(run.first, /^door$/i);
  await toggleLockdown(run.first, true);
  await eventually('the daemon is in lockdown', async () => (await run.status()).lockdown === true);
  await eventually('a banner that says that nobody is let in', async () => /lockdown/i.test(await banner(run.first)));
  await run.shoot(run.first, 'lockdown');
  const before = (await run.status())['visits-allowed'];
  run.rig.show('p01-v1');
  await eventually('p01 is refused because of the lockdown', async () =>
    (await run.records()).some((record) => record.event === 'visit' && record.reason === 'lockdown'), 20000);
  run.rig.show();
  expectEqual((await run.status())['visits-allowed'], before, 'the visits that were let in under lockdown');
  await toggleLockdown(run.first, false);
  await eventually('the lockdown has ended', async () => (await run.status()).lockdown === false);
  await pause(2000);
  await comes(run, 'p01-v1', /p01/);
  const acts = (await run.records()).filter((record) => record.event === 'act').map((record) => record.note).join('\n');
  expect(acts.includes(run.account), `the log was expected to name the account ${run.account} that acted: ${acts}`);
}

// The daemon is killed while a page is open. The page says so, and recovers without being touched.
async function daemonGone(run) {
  await goTo(run.first, /^door$/i);
  await run.rig.stopDaemon('SIGKILL');
  await eventually('a banner that says that the door service does not run', async () => /does not run/.test(await banner(run.first)), 30000);
  await run.shoot(run.first, 'daemon-gone');
  const status = await run.admin.ask('GET', '/status');
  expectEqual(status.body.daemon, false, 'GET /status: "daemon" while it is gone');
  const people = await run.admin.ask('GET', '/people');
  expect(people.status === 503 && people.code === 'no-daemon', `GET /people without a daemon: 503 no-daemon was expected, and ${people.status} ${people.code} came`);
  await run.rig.startDaemon();
  await eventually('the banner goes away by itself', async () => (await banner(run.first)) === '', 30000);
  await comes(run, 'p01-v1', /p01/);
}

// A browser opens at most six connections to a server that speaks HTTP 1.1; a page with streams holds some of them for good.
async function manyTabs(run) {
  const open = [];
  try {
    for (let i = 0; i < 7; i++) {
      const page = await run.browser.open({ context: run.first.context, tab: true });
      await find(page, 'navigation', undefined, 20000);
      open.push(page);
    }
    await goTo(open.at(-1), /^people$/i);
    await seesText(open.at(-1), /p01/, 20000);
  } finally {
    await run.browser.closeAllBut(run.first, run.events);
    await run.first.bringToFront();
  }
}

export async function door(run) {
  await step('p01 comes and is let in, seen live on Door and Events', () => visitors(run));
  await step('a stranger comes and is refused, seen live on Door and Events', () => strangers(run));
  await step('lockdown lets nobody in, is recorded with the account, and is released', () => lockdown(run));
  await step('seven more tabs of one browser work at once', () => manyTabs(run));
  await step('the daemon is killed: a banner appears; it starts again: the page recovers', () => daemonGone(run));
  await run.events?.close();
}

