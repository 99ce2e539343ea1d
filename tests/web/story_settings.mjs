// An administrator changes a setting while the daemon runs, and goes back to the configuration file.
import { eventually, expect, expectEqual, step } from './check.mjs';
import { alerts, find, press, seesAlert, set, textOf } from './browser.mjs';
import { goTo } from './story_login.mjs';
import { examineAll } from './story_pages.mjs';

const settings = async (run) => {
  const answer = await run.admin.ask('GET', '/settings');
  expectEqual(answer.status, 200, 'GET /settings');
  return answer.body.settings;
};
const settingOf = async (run, name) => (await settings(run)).find((one) => `${one.section}.${one.key}` === name);
const lastRecord = async (run) => (await run.records()).filter((record) => record.event === 'setting').at(-1);
const closed = (page) => eventually('the dialog is closed', () => page.evaluate(() => !document.querySelector('dialog[open]')));

async function change(page, name, value) {
  await press(page, 'button', `Change ${name}`);
  await find(page, 'dialog', `Change ${name}`);
  await set(await page.$('dialog [id^=field]'), value);
  await press(page, 'button', /^save$/i);
}

// What the browser itself refuses is not sent; what the daemon refuses is said in the dialog.
async function refused(run, page) {
  await change(page, 'decision.agree', '12');
  await seesAlert(page, /not allowed.*agree is above max_frames/i);
  await run.shoot(page, 'setting-refused');
  await page.keyboard.press('Escape');
  await closed(page);
  await change(page, 'door.unlock_ms', '50');
  expect(await page.evaluate(() => document.querySelector('dialog [id^=field]').validity.rangeUnderflow), 'a number below the least one was expected to be refused by the page');
  await page.keyboard.press('Escape');
  await closed(page);
}

async function changes(run) {
  const page = run.first;
  const before = (await settingOf(run, 'door.unlock_ms')).value;
  await goTo(page, /^settings$/i);
  await eventually('the settings', async () => /unlock_ms/.test(await textOf(page)));
  await press(page, 'button', 'Change decision.level');
  await find(page, 'dialog', 'Change decision.level');
  await examineAll(run, page, 'setting-choice');
  await page.keyboard.press('Escape');
  await closed(page);
  await change(page, 'door.unlock_ms', '4321');
  await closed(page);
  await eventually('the value in force on the page', async () => /4321/.test(await textOf(page)));
  const now = await settingOf(run, 'door.unlock_ms');
  expectEqual([now.value, now.configured, now.changeable].join(), [4321, before, true].join(), 'the value in force, that of the file, and whether it can be changed');
  const record = await lastRecord(run);
  expectEqual([record.reason, record.before, record.after].join(), ['set', before, 4321].join(), 'the record of the change');
  await examineAll(run, page, 'settings-changed');
  await refused(run, page);
  await press(page, 'button', 'Change door.unlock_ms');
  await find(page, 'dialog', 'Change door.unlock_ms');
  await examineAll(run, page, 'setting-number');
  await press(page, 'button', /^as in the file$/i);
  await closed(page);
  expectEqual((await settingOf(run, 'door.unlock_ms')).value, before, 'the value after going back');
  expectEqual((await alerts(page)).join(''), '', 'faults on the page');
}

async function survives(run) {
  const put = await run.admin.ask('PUT', '/settings/hint.interval_ms', { value: '1500' });
  expectEqual(put.status, 200, 'PUT /settings/hint.interval_ms');
  await run.rig.stopDaemon('SIGTERM');
  await run.rig.startDaemon();
  await eventually('the daemon is back', async () => (await run.status()) !== undefined && (await run.admin.ask('GET', '/settings')).status === 200, 30000);
  expectEqual((await settingOf(run, 'hint.interval_ms')).value, '1500', 'the setting after the restart of the daemon');
  expectEqual((await run.admin.ask('DELETE', '/settings/hint.interval_ms')).body.value, '1000', 'the value of the configuration file');
  const fixed = await run.admin.ask('PUT', '/settings/gallery.path', { value: '/tmp/x' });
  expectEqual(`${fixed.status} ${fixed.code}`, '400 invalid-setting', 'a change of a key that needs a restart');
}

export async function settingsInForce(run) {
  await step('a setting is changed on the page, is in force and on record, and goes back', () => changes(run));
  await step('a changed setting holds after a restart of the daemon', () => survives(run));
}
