// The first account of the hub by a one-time code, logins, and what each role may do.
import { eventually, expect, expectEqual, need, step } from '../check.mjs';
import { fillAll, find, press, seesAlert } from '../browser.mjs';
import { logIn } from '../story_login.mjs';
import { pagesOf } from '../story_pages.mjs';

async function setUp(run) {
  const made = run.rig.hub('setup-code');
  expectEqual(made.status, 0, `the exit code of isotherm-hub setup-code (${made.stderr})`);
  const code = /[0-9A-Z]{5}(-[0-9A-Z]{5}){3}/.exec(made.stdout)?.[0];
  expect(code, `a code of four groups was expected: ${made.stdout}`);
  const page = await run.browser.open();
  run.first = page;
  await find(page, 'textbox', /code/i, 20000);
  const form = async (text) => {
    await fillAll(page, [[/code/i, text], [/^account/i, run.account], [/^(password|the same)/i, run.password]]);
    await page.keyboard.press('Enter');
  };
  await run.shoot(page, 'setup');
  await form('AAAAA-AAAAA-AAAAA-AAAAA');
  await seesAlert(page, /code/i);
  await form(code);
  await find(page, 'navigation', undefined, 20000);
  const again = await run.api().ask('POST', '/setup', { code, account: 'another', password: run.password });
  expectEqual(again.status, 401, 'the same code once more');
}

export async function setup(run) {
  await need('a one-time code makes the first account of the hub, once', () => setUp(run));
}

async function observes(run) {
  const made = await run.admin.ask('POST', '/accounts', { name: 'olga', password: run.password, role: 'observer' });
  expectEqual(made.status, 201, 'an account of an observer');
  const page = await run.browser.open();
  await logIn(page, 'olga', run.password);
  const names = (await pagesOf(page)).map(({ name }) => name).join();
  expectEqual(names, 'Overview,Doors,Lockdown,Updates', 'the pages of an observer');
  await press(page, 'link', /^lockdown$/i);
  await find(page, 'heading', /^lockdown$/i);
  await eventually('the zones are listed', () => page.evaluate(() => document.querySelectorAll('main tbody tr').length > 0));
  expect(await page.evaluate(() => !document.querySelector('main button')), 'no button was expected on the page Lockdown of an observer');
  const olga = run.api();
  await olga.login('olga', run.password);
  for (const [method, path, body] of [['PUT', '/lockdown', { on: true }], ['DELETE', '/people/Dora'], ['POST', '/doors', { name: 'x', zones: ['House'] }], ['GET', '/people'], ['GET', '/events']]) {
    const answer = await olga.ask(method, path, body);
    expectEqual(`${answer.status} ${answer.code}`, '403 not-allowed', `${method} ${path} of an observer`);
  }
  await page.close();
}

async function foreign(run) {
  for (const headers of [{ origin: 'https://elsewhere.example' }, { origin: undefined }, { 'sec-fetch-site': 'cross-site' }]) {
    const answer = await run.admin.ask('PUT', '/lockdown', { on: true }, headers);
    expectEqual(`${answer.status} ${answer.code}`, '403 other-origin', `a lockdown with ${JSON.stringify(headers)}`);
  }
}

export async function roles(run) {
  await step('an observer sees four pages and changes nothing', () => observes(run));
  await step('a request from another origin is refused', () => foreign(run));
}
