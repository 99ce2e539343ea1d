// What an administrator does with a fleet: zones, doors, people, and lockdown.
import { eventually, expect, expectEqual, need, step } from '../check.mjs';
import { fill, fillAll, find, press, seesText } from '../browser.mjs';
import { goTo } from '../story_login.mjs';

const closes = (page) => eventually('the dialog closes', () => page.evaluate(() => !document.querySelector('dialog[open]')));
const zoneNow = async (run) => (await run.admin.ask('GET', '/zones/House')).body;

async function tick(page, name) {
  const box = await find(page, 'checkbox', name);
  await box.click();
}

async function addsZones(run) {
  const page = run.first;
  await goTo(page, /^overview$/i);
  for (const name of ['House', 'Garden']) {
    await press(page, 'button', /^add a zone…$/i);
    await fillAll(page, [[/^name$/i, name]]);
    await press(page, 'button', /^add$/i);
    await closes(page);
    await find(page, 'button', name);
  }
  await press(page, 'button', 'House');
  await find(page, 'dialog', 'House');
  await run.shoot(page, 'zone');
  await tick(page, /before they are approved/i);
  await press(page, 'button', /^save$/i);
  await closes(page);
  await eventually('the zone is changed', async () => (await zoneNow(run)).local_people === true);
}

async function addsDoor(run) {
  const page = run.first;
  await goTo(page, /^doors$/i);
  await press(page, 'button', /^add a door…$/i);
  await fillAll(page, [[/^name$/i, 'Front']]);
  await tick(page, 'House');
  await press(page, 'button', /^add$/i);
  await find(page, 'dialog', /Front may join now/);
  const address = await page.evaluate(() => /isotherm:[^']+/.exec(document.querySelector('dialog code').innerText)[0]);
  const [, code] = /&code=([A-Z2-7]{32})$/.exec(address) ?? [];
  expect(code, `an address with a code was expected: ${address}`);
  expect(address.startsWith(`isotherm://127.0.0.1:${run.rig.port}/?ca=`), `the address of this hub was expected: ${address}`);
  await eventually('the QR code is drawn', () => page.evaluate(() => document.querySelector('dialog img.qr').naturalWidth > 0));
  await run.shoot(page, 'join');
  await press(page, 'button', /^close$/i);
  await closes(page);
  await seesText(page, /has not joined yet/i);
  await run.rig.play(`join Front ${code}`);
  await run.rig.play('ask Front');
  await eventually('the tile of the door shows that it is online', () => page.evaluate(() => /Front[^]*Online/.test(document.querySelector('main .tiles').innerText)), 15000);
  const back = await run.admin.ask('POST', '/doors', { name: 'Back', zones: ['House'] });
  await run.rig.play(`join Back ${/&code=(\w+)$/.exec(back.body.join.address)[1]}`);
  await run.rig.play('ask Back');
}

async function approves(run) {
  const page = run.first;
  await run.rig.play('request Front Dora');
  await run.rig.play('request Front Emil');
  await goTo(page, /^requests$/i);
  await press(page, 'button', /^approve….*Dora/i);
  await find(page, 'dialog', /approve dora/i);
  await run.shoot(page, 'approve');
  await press(page, 'button', /^approve$/i);
  await closes(page);
  await press(page, 'button', /^reject….*Emil/i);
  await press(page, 'button', /^reject Emil$/i);
  await closes(page);
  await seesText(page, /nobody waits for approval/i);
  const dora = (await run.admin.ask('GET', '/people/Dora')).body;
  expectEqual(dora.zones.map(({ name }) => name).join(), 'House', 'the zones of Dora: the home of the door');
  expectEqual((await run.admin.ask('GET', '/people/Emil')).status, 404, 'Emil, who was rejected');
}

async function changesPerson(run) {
  const page = run.first;
  await goTo(page, /^people$/i);
  await fill(page, 'searchbox', /search by name/i, 'dor');
  await press(page, 'button', 'Dora');
  await find(page, 'dialog', 'Dora');
  await fillAll(page, [[/^name$/i, 'Dora Maar']]);
  await tick(page, /not heard of the hub/i);
  await tick(page, 'Garden');
  await run.shoot(page, 'person');
  await press(page, 'button', /^save$/i);
  await closes(page);
  await find(page, 'button', 'Dora Maar');
  expectEqual(await page.evaluate(() => document.querySelector('main tbody tr').innerText.split('\t').map((text) => text.trim()).join('|')), 'Dora Maar|Garden, House|no limit|no limit|yes', 'the row of Dora');
  const dora = (await run.admin.ask('GET', '/people/Dora%20Maar')).body;
  expect(dora.offline_ok && dora.zones.length === 2, `offline_ok and two zones were expected: ${JSON.stringify(dora)}`);
}

async function revokes(run) {
  const page = run.first;
  await run.rig.play('ask Front');
  await run.rig.play('ask Back');
  await goTo(page, /^people$/i);
  await press(page, 'button', 'Dora Maar');
  await press(page, 'button', /^revoke now…$/i);
  await press(page, 'button', /^revoke Dora Maar$/i);
  await find(page, 'dialog', /Dora Maar is revoked/i);
  await seesText(page, /not confirmed by doors: 2[^]*Back[^]*Front/i);
  await run.shoot(page, 'revoked');
  await run.rig.play('ask Front');
  await run.rig.play('ask Back');
  await eventually('the dialog shows that all doors have confirmed', () => page.evaluate(() => !/not confirmed by doors/i.test(document.querySelector('dialog').innerText)), 15000);
  await press(page, 'button', /^close$/i);
  await closes(page);
  expectEqual((await run.admin.ask('GET', '/people/Dora%20Maar')).status, 404, 'Dora, who is revoked');
}

async function locksDown(run) {
  const page = run.first;
  await goTo(page, /^lockdown$/i);
  await press(page, 'button', /^begin lockdown… House$/i);
  await press(page, 'button', /^begin lockdown$/i);
  await closes(page);
  await seesText(page, /not confirmed by doors: 2/i);
  await run.rig.play('ask Front');
  await eventually('one door is left', () => page.evaluate(() => /not confirmed by doors: 1[^]*Back/i.test(document.querySelector('main').innerText) && !/Front/.test(document.querySelector('main').innerText)), 15000);
  await run.shoot(page, 'lockdown');
  await seesText(page, /zones in lockdown: 1/i);
  expect((await zoneNow(run)).lockdown, 'the zone was expected to be in lockdown');
  await goTo(page, /^doors$/i);
  await seesText(page, /has not confirmed the last change/i);
  await press(page, 'button', /^Back/);
  await find(page, 'dialog', 'Back');
  await run.shoot(page, 'door');
  await press(page, 'button', /^close$/i);
  await closes(page);
  await goTo(page, /^lockdown$/i);
  await press(page, 'button', /^end lockdown of all zones…$/i);
  await press(page, 'button', /^end lockdown$/i);
  await closes(page);
  await eventually('the lockdown has ended', async () => !(await zoneNow(run)).lockdown);
}

async function events(run) {
  const page = run.first;
  await run.rig.play('events Front 1 5');
  await goTo(page, /^who was where$/i);
  await press(page, 'button', /^load again$/i);
  await eventually('five records', () => page.evaluate(() => document.querySelectorAll('main tbody tr').length === 5));
  await page.select(`main .bar.fields select`, (await run.admin.ask('GET', '/doors/Back')).body.id);
  await eventually('no record of the other door', () => page.evaluate(() => document.querySelectorAll('main tbody tr').length === 0));
}

async function acts(run) {
  const found = (await run.admin.ask('GET', '/acts?max=1000')).body.acts;
  for (const act of ['setup', 'zone-add', 'zone-set', 'door-add', 'request-approve', 'request-reject', 'person-rename', 'person-zones', 'person-revoke', 'lockdown']) {
    expect(found.some((one) => one.act === act && one.actor === run.account), `an act ${act} of ${run.account} was expected`);
  }
}

async function expels(run) {
  const page = run.first;
  const added = await run.admin.ask('POST', '/doors', { name: 'Cellar', zones: ['Garden'] });
  expectEqual(added.status, 201, 'a further door');
  await goTo(page, /^doors$/i);
  await press(page, 'button', /^Cellar/);
  await press(page, 'button', /^expel…$/i);
  await press(page, 'button', /^expel Cellar$/i);
  await find(page, 'dialog', /Cellar is expelled/i);
  await press(page, 'button', /^close$/i);
  await closes(page);
  await eventually('the tile is gone', () => page.evaluate(() => !/Cellar/.test(document.querySelector('main').innerText)));
}

async function updates(run) {
  const page = run.first;
  await goTo(page, /^updates$/i);
  await seesText(page, /no update was rolled out yet/i);
  for (const words of [['add', run.rig.makeUpdate('1.2', 'pc')], ['roll', '1.2', '--zone', 'House', '--first', '1']]) {
    const done = run.rig.hub('update', ...words);
    expectEqual(done.status, 0, `isotherm-hub update ${words[0]} (${done.stderr})`);
  }
  await run.rig.play('update Front idle 1.1');
  await run.rig.play('ask Back');
  await eventually('the rollout is shown', () => page.evaluate(() => /0 of 2 run it[^]*At work: 1[^]*Take no part: 1/.test(document.querySelector('main').innerText)), 15000);
  await seesText(page, /under way/i);
  await press(page, 'button', 'House');
  await find(page, 'dialog', 'House');
  await seesText(page, /Front[^]*was told/i);
  await seesText(page, /Back[^]*takes no part/i);
  await run.shoot(page, 'rollout');
  await press(page, 'button', /^close$/i);
  await closes(page);
  await press(page, 'button', /^stop… house$/i);
  await find(page, 'dialog', /stop the rollout of 1\.2 in house/i);
  await press(page, 'button', /^stop it$/i);
  await seesText(page, /the rollout is stopped/i);
  await eventually('the rollout is shown as stopped', () => page.evaluate(() => /Stopped by [^]*0 of 2 run it/.test(document.querySelector('main').innerText)), 15000);
  await press(page, 'button', /^let it go on… house$/i);
  await find(page, 'dialog', /let the rollout of 1\.2 in house go on/i);
  await press(page, 'button', /^let it go on$/i);
  await seesText(page, /the rollout goes on/i);
  await eventually('the rollout is under way again', () => page.evaluate(() => /Under way[^]*0 of 2 run it/.test(document.querySelector('main').innerText)), 15000);
  await run.rig.play('update Front healthy 1.2');
  await eventually('the rollout is done', () => page.evaluate(() => /Done[^]*1 of 2 run it/.test(document.querySelector('main').innerText)), 15000);
}

async function crowd(run) {
  for (let i = 0; i < 4; i++) {
    await run.rig.play(`person House person-${i}`);
  }
  await run.admin.ask('POST', '/doors', { name: 'Gate', zones: ['Garden', 'House'] });
  await run.rig.play('request Back Frida');
}

export async function fleet(run) {
  await need('zones are added and one is changed', () => addsZones(run));
  await need('a door is added, joins by the address of the page, and is online', () => addsDoor(run));
  await step('a request is approved and another one rejected', () => approves(run));
  await step('a person gets another name, another zone, and may enter offline', () => changesPerson(run));
  await step('a person is revoked, and the page waits for the doors', () => revokes(run));
  await step('a lockdown names the door that has not confirmed, and ends', () => locksDown(run));
  await step('who was where: records of one door', () => events(run));
  await step('a door is expelled', () => expels(run));
  await step('an update: the file, how far the zone is, and its doors', () => updates(run));
  await step('each change is on record in the name of the account', () => acts(run));
  await step('further people, a door that waits, and a request', () => crowd(run));
}
