// Cards and the policy: a card and a PIN on People, a policy stored from the page Policy, its questions, and what it does at the door.
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { eventually, expect, expectEqual, pause, Skip, step } from './check.mjs';
import { find, press, seesText, set, textOf, type } from './browser.mjs';
import { goTo } from './story_login.mjs';
import { examineAll } from './story_pages.mjs';

const SAVE = /^save$/i;
const STORE = /^store$/i;
const DAYS = ['00:00-24:00'];

// One door that is open to the staff at any time, today as a special day, and a profile that can never let anybody in.
function document() {
  const today = new Date();
  const date = [today.getFullYear(), today.getMonth() + 1, today.getDate()].map((part) => String(part).padStart(2, '0')).join('-');
  const zone = Intl.DateTimeFormat().resolvedOptions().timeZone;
  return {
    special_day_groups: [{ token: 'open-house', days: [date] }],
    schedules: [
      { token: 'always', zone, weekly: { 'monday-friday': DAYS, 'saturday-sunday': ['00:00-12:00', '12:00-24:00'] },
        special_days: [{ group: 'open-house', hours: DAYS }] },
      { token: 'never', zone, weekly: {} },
    ],
    areas: [{ token: 'outside' }, { token: 'office' }],
    security_levels: [{ token: 'face', recognition_groups: [['face']] }, { token: 'face-and-card', recognition_groups: [['face', 'card']] }],
    authentication_profiles: [{ token: 'usual', default_level: 'face' }, { token: 'strict', default_level: 'face-and-card' }],
    access_points: [{ token: 'front', from: 'outside', to: 'office', authentication_profile: 'usual', antipassback: 'soft' }],
    access_profiles: [
      { token: 'staff', policies: [{ access_point: 'front', schedule: 'always' }] },
      { token: 'ghosts', policies: [{ access_point: 'front', schedule: 'never' }] },
    ],
    default_profile: 'staff',
  };
}

const closes = (page) => eventually('the dialog closes', () => page.evaluate(() => !document.querySelector('dialog[open]')));
const credential = async (run, name) => (await run.admin.ask('GET', `/people/${encodeURIComponent(name)}/credential`)).body;
const policy = async (run) => (await run.admin.ask('GET', '/policy')).body;

async function openCredential(page, name) {
  await goTo(page, /^people$/i);
  await press(page, 'button', name);
  await find(page, 'dialog', name);
  await press(page, 'button', /^cards and access…$/i);
  await find(page, 'dialog', new RegExp(`^cards and access of ${name}`, 'i'));
  await find(page, 'button', /^add a card$/i);
}

// In a run of these steps alone, nobody has been enrolled before.
async function enrolsIfMissing(run) {
  if (!(await run.people()).some((one) => one.name === 'p01')) {
    run.rig.show('p01-enrol');
    const enrolled = run.rig.isotherm('enroll', 'p01', '--quick');
    expectEqual(enrolled.status, 0, `the exit code of isotherm enroll (${enrolled.stderr})`);
    run.rig.show();
  }
}

async function addsCard(run) {
  await enrolsIfMissing(run);
  const page = run.first;
  await openCredential(page, 'p01');
  await press(page, 'button', /^add a card$/i);
  await type(await find(page, 'textbox', 'Card 1'), '17-4711');
  await press(page, 'button', SAVE);
  await seesText(page, /does not accept this/i);
  await type(await find(page, 'textbox', 'Card 1'), '17/4711');
  await run.shoot(page, 'person-cards');
  await press(page, 'button', SAVE);
  await closes(page);
  await seesText(page, /17\/4711/);
  expectEqual((await credential(run, 'p01')).cards.join(), '17/4711', 'the cards of p01');
  expectEqual((await run.people()).find((one) => one.name === 'p01').cards.join(), '17/4711', 'the cards of p01 in the list');
  const acts = (await run.records()).filter((record) => record.event === 'act' && record.person === 'p01').map((record) => record.note);
  expect(acts.some((note) => note.startsWith(`credential, asked by ${run.account} `)), `an act "credential" of ${run.account} was expected: ${acts}`);
}

async function oneHolder(run) {
  if (!(await run.people()).some((one) => one.name === 'Ada Lovelace')) {
    throw new Skip('a second person is enrolled only in a run of all steps');
  }
  const twice = await run.admin.ask('PATCH', '/people/Ada%20Lovelace/credential', { cards: ['17/4711'] });
  expect(twice.status === 409 && twice.code === 'card-in-use', `a card of another person: 409 card-in-use was expected, and ${twice.status} ${twice.code} came`);
}

// The password fields of the dialog: PIN twice, duress PIN twice.
const pins = (page) => page.$$('dialog input[type=password]');

async function setsPin(run) {
  const page = run.first;
  await openCredential(page, 'p01');
  const fields = await pins(page);
  expectEqual(fields.length, 4, 'the fields for PINs');
  await type(fields[0], '4711');
  await type(fields[1], '4712');
  await press(page, 'button', SAVE);
  await seesText(page, /the two PINs are different/i);
  await type(fields[1], '4711');
  await press(page, 'button', SAVE);
  await closes(page);
  expectEqual((await credential(run, 'p01')).pin, true, 'whether p01 has a PIN');
  await openCredential(page, 'p01');
  await seesText(page, /it is set/i);
  const values = await page.$$eval('dialog input', (all) => all.map((one) => one.value).join(' '));
  expect(!values.includes('4711 4711') && !/\b4711\b(?<!17\/4711)/.test(values), `no PIN was expected in the dialog: ${values}`);
  await press(page, 'checkbox', /^remove it$/i);
  await press(page, 'button', SAVE);
  await closes(page);
  expectEqual((await credential(run, 'p01')).pin, false, 'whether p01 has a PIN after its removal');
  const log = JSON.stringify(await run.records());
  expect(!/"pin":"4711"|\\"pin\\":\\"4711\\"/.test(log), 'no PIN was expected in the log');
}

async function enrollers(run) {
  const client = run.api();
  await client.login('role-enroller', run.password);
  for (const [method, path] of [['GET', '/policy'], ['GET', '/policy/findings'], ['GET', '/policy/test?person=p01'], ['GET', '/people/p01/credential']]) {
    const answer = await client.ask(method, path);
    expect(answer.status === 403 && answer.code === 'not-allowed', `${method} ${path} as enroller: 403 was expected, and ${answer.status} ${answer.code} came`);
  }
  const people = (await client.ask('GET', '/people')).body.people;
  expect(people.every((one) => one.cards === undefined && one.enabled === undefined), `an enroller was expected to see no cards: ${JSON.stringify(people)}`);
}

async function stores(run) {
  const page = run.first;
  await goTo(page, /^policy$/i);
  await seesText(page, /there is no policy/i);
  await run.shoot(page, 'policy-none');
  await press(page, 'button', /^begin with an example…$/i);
  const area = await find(page, 'textbox', /^document$/i);
  const example = JSON.parse(await area.evaluate((element) => element.value));
  expect(example.access_profiles.length === 1, 'the example was expected to have one access profile');
  await run.shoot(page, 'policy-json');
  await set(area, '{"schedules": [');
  await press(page, 'button', STORE);
  await seesText(page, /this is no JSON/i);
  await set(area, JSON.stringify({ ...document(), default_profile: 'stuff' }));
  await press(page, 'button', STORE);
  await seesText(page, /does not accept this policy[^]*stuff/i);
  await set(area, JSON.stringify(document()));
  await press(page, 'button', STORE);
  await closes(page);
  await seesText(page, /revision \d+ is in force/i);
  expectEqual((await policy(run)).document.default_profile, 'staff', 'the default profile of the stored policy');
  const stale = await run.admin.ask('PUT', '/policy', { revision: 0, document: null });
  expect(stale.status === 409 && stale.code === 'policy-changed', `a change of an old revision: 409 policy-changed was expected, and ${stale.status} ${stale.code} came`);
}

async function showsWeek(run) {
  const page = run.first;
  await goTo(page, /^policy$/i);
  await seesText(page, /this week/i);
  const week = await page.$eval('.week', (table) => ({
    today: table.querySelectorAll('thead [aria-current=date]').length,
    marks: [...table.querySelectorAll('td.special.today .mark')].map((one) => one.innerText),
    bars: table.querySelectorAll('rect.open').length,
  }));
  expectEqual(week.today, 1, 'the columns of today');
  expect(week.marks.length === 1 && /open-house/.test(week.marks[0]), `today was expected to be marked as open-house: ${week.marks}`);
  expect(week.bars >= 7, `a bar for each day was expected, and ${week.bars} are there`);
  const findings = (await run.admin.ask('GET', '/policy/findings')).body.findings;
  expect(findings.some((one) => /ghosts|never/.test(one)), `a finding about the profile or schedule that lets nobody in was expected: ${findings}`);
  await seesText(page, new RegExp(findings[0].replace(/[.*+?^${}()|[\]\\]/g, '\\$&')));
  await run.shoot(page, 'policy');
}

async function asks(run) {
  const page = run.first;
  await goTo(page, /^policy$/i);
  await type(await find(page, 'combobox', /^person$/i), 'p01');
  await press(page, 'button', /^ask$/i);
  await seesText(page, /would be let in/i);
  await press(page, 'checkbox', /^face$/i);
  await press(page, 'button', /^ask$/i);
  await seesText(page, /wanted besides: face/i);
  await press(page, 'button', /^show who may enter now$/i);
  await seesText(page, /may enter now: \d+ of \d+/i, 20000);
  const names = await page.$$eval('.names li', (all) => all.map((one) => one.innerText.trim()));
  expect(names.includes('p01'), `p01 was expected among those who may enter: ${names}`);
  await run.shoot(page, 'policy-questions');
}

// The dialogs, in both themes and sizes.
async function dialogs(run) {
  const page = run.first;
  await openCredential(page, 'p01');
  await examineAll(run, page, 'dialog-access');
  await page.keyboard.press('Escape');
  await closes(page);
  for (const [button, name] of [[/^edit always$/i, 'dialog-hours'], [/^edit open-house$/i, 'dialog-dates'], [/^change as JSON…$/i, 'dialog-json']]) {
    await goTo(page, /^policy$/i);
    await press(page, 'button', button);
    await find(page, 'button', STORE);
    await examineAll(run, page, name);
    await page.keyboard.press('Escape');
    await closes(page);
  }
}

// How often the page Door shows a text after somebody has come.
async function comes(run, pattern, picture) {
  const count = async () => ((await textOf(run.first)).match(pattern) ?? []).length;
  await goTo(run.first, /^door$/i);
  await pause(1000); // until the page has read the earlier visits
  const before = await count();
  run.rig.show('p01-v1');
  try {
    await eventually(`one more ${pattern} on Door`, async () => (await count()) > before, 20000);
    await run.shoot(run.first, picture);
  } finally {
    run.rig.show();
  }
  await pause(2500); // until the visit is over and the door is locked again
}

// The file of people has cards, and gives them back.
async function csvOfCards(run) {
  const page = run.first;
  const file = join(run.rig.scratch, 'cards.csv');
  writeFileSync(file, 'name,cards\r\np01,17/4711 17/4712\r\n');
  await goTo(page, /^people$/i);
  await seesText(page, /17\/4711/);
  const [chooser] = await Promise.all([page.waitForFileChooser(), press(page, 'button', /^import csv…$/i)]);
  await chooser.accept([file]);
  await seesText(page, /cards: 17\/4711 → 17\/4711 17\/4712/i);
  await press(page, 'button', /^change people: 1$/i);
  await eventually('the cards of the file are stored', async () => (await credential(run, 'p01')).cards.join() === '17/4711,17/4712');
  await seesText(page, /changed: 1\. failed: 0/i);
  await press(page, 'button', /^close$/i);
  await closes(page);
  const folder = join(run.rig.scratch, 'cards-download');
  const session = await page.createCDPSession();
  await session.send('Browser.setDownloadBehavior', { behavior: 'allow', downloadPath: folder, browserContextId: page.context.id });
  await seesText(page, /17\/4712/);
  await press(page, 'button', /^export csv$/i);
  const name = await eventually('a file that is downloaded', () => readdirSync(folder).find((one) => one.endsWith('.csv')));
  expect(/,cards\r\n[^]*p01,[^]*,17\/4711 17\/4712\r\n/.test(readFileSync(join(folder, name), 'utf8')), 'the exported file was expected to have the cards');
}

// The special day of today and the hours of the week, from the page.
async function setHours(page, hours, special) {
  await goTo(page, /^policy$/i);
  await press(page, 'button', /^edit open-house$/i);
  await set(await find(page, 'textbox', /^dates$/i), special);
  await press(page, 'button', STORE);
  await closes(page);
  await eventually('the focus is on the button again', () => page.evaluate(() => /edit open-house/i.test(document.activeElement.ariaLabel)));
  await press(page, 'button', /^edit always$/i);
  await find(page, 'dialog', /^hours of always$/i);
  for (const field of await page.$$('dialog input')) {
    await set(field, hours);
  }
  await press(page, 'button', STORE);
  await closes(page);
}

async function outside(run) {
  const page = run.first;
  const today = document().special_day_groups[0].days[0];
  const allowed = (await run.status())['visits-allowed'];
  await setHours(page, '', '2020-01-01');
  expectEqual(Object.keys((await policy(run)).document.schedules[0].weekly ?? {}).length, 0, 'the days with hours');
  await comes(run, /outside the schedule/gi, 'policy-refused');
  expectEqual((await run.status())['visits-allowed'], allowed, 'the visits that were let in outside the schedule');
  await setHours(page, DAYS[0], today);
  await comes(run, /let in/gi, 'policy-let-in');
}

async function wantsCard(run) {
  const strict = (level) => ({ ...document(), access_points: document().access_points.map((one) => ({ ...one, authentication_profile: level })) });
  const store = async (level) => {
    const { revision } = await policy(run);
    const answer = await run.admin.ask('PUT', '/policy', { revision, document: strict(level) });
    expectEqual(answer.status, 200, `PUT /policy with the level of ${level}`);
  };
  await store('strict');
  try {
    await goTo(run.first, /^door$/i);
    run.rig.show('p01-v1');
    await seesText(run.first, /show your card[^]*hold it to the reader/i, 20000);
    await run.shoot(run.first, 'door-wants-card');
    run.rig.show();
    await eventually('the visit ends without a card', async () =>
      (await run.records()).some((record) => record.event === 'visit' && record.reason === 'not-enough'), 30000);
    await seesText(run.first, /card, PIN or second person missing/i);
  } finally {
    run.rig.show();
    await store('usual');
  }
}

async function downloads(run) {
  const page = run.first;
  const folder = join(run.rig.scratch, 'policy-download');
  const session = await page.createCDPSession();
  await session.send('Browser.setDownloadBehavior', { behavior: 'allow', downloadPath: folder, browserContextId: page.context.id });
  await goTo(page, /^policy$/i);
  await press(page, 'button', /^download$/i);
  const name = await eventually('a file that is downloaded', () => readdirSync(folder).find((file) => file.endsWith('.json')));
  const { document: stored, revision } = await policy(run);
  expectEqual(JSON.stringify(JSON.parse(readFileSync(join(folder, name), 'utf8'))), JSON.stringify(stored), 'the downloaded policy');
  const [chooser] = await Promise.all([page.waitForFileChooser(), press(page, 'button', /^upload a file…$/i)]);
  await chooser.accept([join(folder, name)]);
  await eventually('the uploaded policy is stored', async () => (await policy(run)).revision === revision + 1);
  await seesText(page, new RegExp(`revision ${revision + 1} is in force`, 'i'));
}

// The policy stays in force for the steps after these. Everybody is let in with the face at any time, as without it.
export async function policies(run) {
  await step('access: a card is added to a person, shown in the list, and put on record', () => addsCard(run));
  await step('access: a card belongs to one person', () => oneHolder(run));
  await step('access: a PIN is typed twice, set, never shown, and removed', () => setsPin(run));
  await step('access: a CSV file carries cards in and out', () => csvOfCards(run));
  await step('access: an enroller sees no cards and no policy (403)', () => enrollers(run));
  await step('access: a policy is stored from the page, after it was refused with the line of the daemon', () => stores(run));
  await step('access: the week of the door marks today, and a finding is shown', () => showsWeek(run));
  await step('access: the page answers who would be let in', () => asks(run));
  await step('access: the dialogs keep the rules of accessibility in both themes and sizes', () => dialogs(run));
  await step('access: p01 is refused outside the schedule, live, and let in within it', () => outside(run));
  await step('access: the page Door says that a card is wanted', () => wantsCard(run));
  await step('access: the policy is downloaded and uploaded', () => downloads(run));
}
