// The first start: a one-time code makes the first account; then logins, right and wrong.
import { eventually, expect, expectEqual, need, pause, step } from './check.mjs';
import { fillAll, find, press, seesAlert } from './browser.mjs';

export const NAV = 'navigation';

// Logs in on a page that shows the form.
export async function logIn(page, account, password, { fails = false } = {}) {
  await find(page, 'button', /^log in$/i, 20000);
  await fillAll(page, [[/^account$/i, account], [/^password$/i, password]]);
  await press(page, 'button', /^log in$/i);
  if (!fails) {
    await find(page, NAV, undefined, 20000);
  }
}

// Goes to a page by the link of the navigation with this name.
export async function goTo(page, name) {
  await press(page, 'link', name);
  await eventually(`the page ${name}`, () => page.evaluate((text) =>
    [...document.querySelectorAll('main h1')].some((head) => new RegExp(text, 'i').test(head.innerText)), name.source ?? name));
}

async function logOut(page, account) {
  const menu = await page.waitForSelector('header details summary');
  expectEqual(await menu.evaluate((element) => element.innerText.trim()), account, 'the account that the page names');
  await menu.click();
  await press(page, 'button', /^log out$/i);
}

async function setUp(run) {
  const made = run.rig.web('setup-code');
  expectEqual(made.status, 0, `the exit code of isotherm-web setup-code (${made.stderr})`);
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
  await find(page, NAV, undefined, 20000);
  const again = await run.api().ask('POST', '/setup', { code, account: 'another', password: run.password });
  expectEqual(again.status, 401, 'the same code once more');
}

async function logsOutAndIn(run) {
  const page = run.first;
  await logOut(page, run.account);
  await find(page, 'button', /^log in$/i);
  await run.shoot(page, 'login');
  await logIn(page, run.account, 'not the password', { fails: true });
  await seesAlert(page, /password/i);
  await pause(1100); // the third failure of the run: after it, every further attempt has to wait
  await logIn(page, run.account, run.password);
}

// The steps before have failed three times from this address: each further failure has to wait, longer and longer, and meanwhile the right
// password is refused, too.
async function guessesAreSlowed(run) {
  const client = run.api();
  const guess = (password) => client.ask('POST', '/session', { account: run.account, password });
  const page = await run.browser.open();
  let waitS = 1;
  // The delay doubles. One of four seconds leaves the browser time to meet it.
  for (let number = 1; waitS < 4; number++) {
    await pause(waitS * 1000 + 100);
    expectEqual((await guess(`guess number ${number}`)).status, 401, `guess ${number}, after the wait`);
    const answer = await guess('a guess at once');
    expect(answer.status === 429 && answer.code === 'too-many-attempts', `a guess at once: 429 too-many-attempts was expected, and ${answer.status} ${answer.code} came`);
    waitS = Number(answer.headers['retry-after']);
    expect(waitS >= 1 && waitS <= 60, `Retry-After of 1 to 60 s was expected: ${answer.headers['retry-after']}`);
  }
  expectEqual((await guess(run.password)).status, 429, 'the right password during the wait');
  await logIn(page, run.account, run.password, { fails: true });
  await seesAlert(page, /too many|wait|again in|seconds/i);
  await page.close();
  await pause(waitS * 1000 + 100);
  expectEqual((await guess(run.password)).status, 201, 'the right password after the wait');
}

export async function login(run) {
  await need('a one-time code makes the first account, once', () => setUp(run));
  await step('the account logs out, and in again; a wrong password is refused', () => logsOutAndIn(run));
  await step('guesses are slowed down', () => guessesAreSlowed(run));
}

// The session ends while a page is open: the page asks for the password, and then goes on where it was.
async function expires(run) {
  const page = await run.browser.open();
  await logIn(page, 'role-enroller', run.password);
  await goTo(page, /^people$/i);
  await run.admin.ask('PATCH', '/accounts/role-enroller', { role: 'observer' });
  await run.admin.ask('PATCH', '/accounts/role-enroller', { role: 'enroller' });
  await find(page, 'dialog', /log in again/i, 20000);
  await run.shoot(page, 'session-ended');
  await fillAll(page, [[/^password$/i, run.password]]);
  await press(page, 'button', /^log in$/i);
  await eventually('the dialog closes', () => page.evaluate(() => !document.querySelector('dialog[open]')));
  await eventually('the page People stays', () => page.evaluate(() => /people/i.test(document.querySelector('main h1').innerText)));
  await page.close();
}

export async function oldSession(run) {
  await step('a page whose session has ended asks for the password and goes on', () => expires(run));
}
