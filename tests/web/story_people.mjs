// The list of people: renaming, limits, the way out to a CSV file and back, and removal.
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { eventually, expect, expectEqual, step } from './check.mjs';
import { fillAll, find, press, seesText, set } from './browser.mjs';
import { goTo } from './story_login.mjs';

const HOUR_S = 3600;

// A time as a field "datetime-local" has it, in the zone of the machine.
function localTime(seconds) {
  const time = new Date(seconds * 1000);
  return new Date(time - time.getTimezoneOffset() * 60000).toISOString().slice(0, 16);
}

const SAVE = /^save$/i;

// Opens the dialog of a person.
async function openPerson(page, name) {
  await goTo(page, /^people$/i);
  await press(page, 'button', name);
  await find(page, 'dialog', name);
}

// Until no dialog is open.
const closes = (page) => eventually('the dialog closes', () => page.evaluate(() => !document.querySelector('dialog[open]')));

const person = async (run, name) => (await run.people()).find((one) => one.name === name);

async function renames(run) {
  const page = run.first;
  await openPerson(page, 'ada');
  await fillAll(page, [[/^name$/i, 'Ada Lovelace']]);
  await run.shoot(page, 'people-edit');
  await press(page, 'button', SAVE);
  await closes(page);
  await seesText(page, 'Ada Lovelace');
  expect(await person(run, 'Ada Lovelace'), 'a person called Ada Lovelace was expected');
  expect(!(await person(run, 'ada')), 'nobody called ada was expected');
}

async function limits(run) {
  const page = run.first;
  const until = Math.floor(Date.now() / 60000) * 60 - HOUR_S;
  await openPerson(page, 'Ada Lovelace');
  const fields = await page.$$('dialog input[type=datetime-local]');
  expectEqual(fields.length, 2, 'the fields for the limits');
  const future = Math.floor(Date.now() / 60000) * 60 + 24 * HOUR_S;
  await set(fields[0], localTime(until));
  await set(fields[1], localTime(future));
  await press(page, 'button', SAVE);
  await eventually('the limits are stored', async () => {
    const ada = await person(run, 'Ada Lovelace');
    return ada.valid_from_s === until && ada.valid_until_s === future;
  });
  const refused = await run.admin.ask('PATCH', '/people/Ada%20Lovelace', { valid_from_s: future, valid_until_s: until });
  expectEqual(refused.code, 'invalid-limits', 'limits in the wrong order');
}

// What the browser has downloaded.
async function download(run, page, act) {
  const folder = join(run.rig.scratch, `downloads-${Date.now()}`);
  const session = await page.createCDPSession();
  await session.send('Browser.setDownloadBehavior', { behavior: 'allow', downloadPath: folder, browserContextId: page.context.id });
  await act();
  const name = await eventually('a file that is downloaded', () => readdirSync(folder).find((file) => file.endsWith('.csv')));
  return readFileSync(join(folder, name), 'utf8');
}

async function csv(run) {
  const page = run.first;
  await goTo(page, /people/i);
  const text = await download(run, page, () => press(page, 'button', /^export csv$/i));
  writeFileSync(join(run.out, 'people.csv'), text);
  expect(/p01/.test(text) && /Ada Lovelace/.test(text), `the file was expected to have both people: ${text}`);
  const rows = text.replace(/^\uFEFF/, '').trim().split(/\r?\n/);
  const heads = rows[0].split(',');
  const column = heads.indexOf('valid_until');
  expect(column > 0, `a column valid_until was expected: ${rows[0]}`);
  const until = '2040-02-03T04:05:06Z';
  const changed = rows.map((row, i) => {
    const cells = row.split(',');
    return i && cells[0] === 'p01' ? cells.map((cell, k) => (k === column ? until : cell)).join(',') : row;
  });
  const file = join(run.rig.scratch, 'changed.csv');
  writeFileSync(file, `${changed.join('\r\n')}\r\nmallory,,,,,\r\n`);
  const before = JSON.stringify(await run.people());
  const [chooser] = await Promise.all([page.waitForFileChooser(), press(page, 'button', /^import csv…$/i)]);
  await chooser.accept([file]);
  await seesText(page, /mallory[^]*not enrolled here/i);
  await run.shoot(page, 'people-import');
  expectEqual(JSON.stringify(await run.people()), before, 'the people while the page only shows what the file would change');
  await press(page, 'button', /^change people: 1$/i);
  await eventually('the limit of the file is stored', async () => (await person(run, 'p01')).valid_until_s === Date.parse(until) / 1000);
  expect(!(await person(run, 'mallory')), 'nobody was expected to be enrolled by a file');
  await seesText(page, /changed: 1\. failed: 0/i);
  await press(page, 'button', /^close$/i);
  await closes(page);
}

async function removes(run) {
  const page = run.first;
  await openPerson(page, 'p01');
  await press(page, 'button', /^remove…$/i);
  const dialog = await find(page, 'dialog', /^remove p01/i);
  expect(/cannot be undone/i.test(await dialog.evaluate((element) => element.innerText)), 'the question was expected to say that a removal cannot be undone');
  await run.shoot(page, 'people-remove');
  await press(page, 'button', /^cancel$/i);
  expect(await person(run, 'p01'), 'p01 was expected to stay after Cancel');
  await openPerson(page, 'p01');
  await press(page, 'button', /^remove…$/i);
  await press(page, 'button', /^remove p01$/i);
  await eventually('p01 is removed', async () => !(await person(run, 'p01')));
  await eventually('p01 leaves the list', () => page.evaluate(() => !/\bp01\b/.test(document.querySelector('main table')?.innerText ?? '')));
  const denied = (await run.status())['visits-denied'];
  run.rig.show('p01-v1');
  await eventually('p01, who is removed, is refused', async () => (await run.status())['visits-denied'] > denied, 20000);
  run.rig.show();
}

// Before the door closes: the list and its changes.
export async function people(run) {
  await step('a person gets another name', () => renames(run));
  await step('a person gets limits', () => limits(run));
  await step('CSV: exported, changed, looked at, applied', () => csv(run));
}

export async function removal(run) {
  await step('p01 is removed after a question, and is then refused at the door', () => removes(run));
}
