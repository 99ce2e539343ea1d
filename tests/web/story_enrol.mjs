// People are enrolled through the page: with consent, step by step, and with a relief of the person before the camera.
import { eventually, expect, expectEqual, step } from './check.mjs';
import { fillAll, find, press, seesText } from './browser.mjs';
import { colours } from './picture.mjs';
import { goTo, logIn } from './story_login.mjs';

// The recordings of a person who turns the head as the page asks, in the order of the steps.
const POSES = ['', '-left', '-right', '-down', '-up'].map((pose) => `poses/p0000-s0${pose}`);

const [CONSENT, TURNED, BEGIN] = [/consents/i, /turned to the sides/i, /^begin$/i];

// Opens the form anew: a page that is shown already does not change.
async function openForm(page, name) {
  await goTo(page, /^people$/i);
  await goTo(page, /^enrol$/i);
  await fillAll(page, [[/^name$/i, name]]);
}

// Sets a box or a choice by its label.
export async function choose(page, role, name, on) {
  const handle = await find(page, role, name);
  if ((await handle.evaluate((element) => element.checked)) !== on) {
    await handle.click();
  }
  expectEqual(await handle.evaluate((element) => element.checked), on, `the state of ${role} ${name}`);
}

// The picture of the canvas has shades: something is drawn.
async function seesRelief(page) {
  return eventually('a relief of many shades of grey', async () => {
    for (const canvas of await page.$$('canvas')) {
      if ((await canvas.boundingBox()) && colours(await canvas.screenshot()) > 40) {
        return true;
      }
    }
    return false;
  }, 20000);
}

async function withoutConsent(run) {
  const page = run.first;
  await openForm(page, 'p01');
  await press(page, 'button', BEGIN);
  await new Promise((resolve) => setTimeout(resolve, 500));
  expectEqual((await run.admin.ask('GET', '/enrolment')).body.state, 'none', 'the enrolment without consent');
  const answer = await run.admin.ask('POST', '/enrolment', { person: 'p01', consent: false });
  expect(answer.status === 400 && answer.code === 'consent-required', `an enrolment without consent: 400 consent-required was expected, and ${answer.status} ${answer.code} came`);
  expectEqual((await run.people()).length, 0, 'the people after an enrolment without consent');
}

async function frontally(run) {
  const page = run.first;
  run.rig.show();
  await openForm(page, 'p01');
  await choose(page, 'checkbox', CONSENT, true);
  await choose(page, 'checkbox', TURNED, false);
  await press(page, 'button', BEGIN);
  await eventually('the enrolment goes on', async () => (await run.admin.ask('GET', '/enrolment')).body.state === 'running');
  run.rig.show('none-back1'); // the back of a head has a relief, and is no face that could be enrolled
  await seesRelief(page);
  await run.shoot(page, 'enrol-relief');
  run.rig.show('p01-enrol');
  await seesText(page, /the person is enrolled/i, 30000);
  run.rig.show();
  await run.shoot(page, 'enrol-done');
  const people = await run.people();
  expectEqual(people.map((person) => `${person.name} ${person.templates}`).join(), 'p01 1', 'the people after the enrolment');
  const records = await run.records();
  expect(records.some((record) => record.event === 'act' && /consent/.test(record.note) && record.person === 'p01'),
    'a record of the consent of p01 was expected in the log');
}

async function inPoses(run) {
  const page = run.first;
  await openForm(page, 'ada');
  await choose(page, 'checkbox', CONSENT, true);
  await choose(page, 'checkbox', TURNED, true);
  await press(page, 'button', BEGIN);
  for (let number = 0; number < POSES.length; number++) {
    await eventually(`step ${number + 1} of the enrolment begins`, async () => {
      const steps = (await run.admin.ask('GET', '/enrolment')).body.steps ?? [];
      return steps.length > number && ['begun', 'turn'].includes(steps[number].state);
    }, 40000);
    run.rig.show(POSES[number]);
    if (number === 1) {
      await seesText(page, /left/i);
      await seesRelief(page);
      await page.evaluate(() => scrollTo(0, 0));
      await run.shoot(page, 'enrol-steps');
    }
  }
  await seesText(page, /the person is enrolled/i, 40000);
  run.rig.show();
  const ada = (await run.people()).find((person) => person.name === 'ada');
  expectEqual(ada?.templates, 5, 'the templates of ada, who turned as the page asked');
}

// The same face under another name is refused, and the page says whose it is.
async function twice(run) {
  const page = run.first;
  await openForm(page, 'impostor');
  await choose(page, 'checkbox', CONSENT, true);
  await choose(page, 'checkbox', TURNED, false);
  await press(page, 'button', BEGIN);
  await eventually('the enrolment goes on', async () => (await run.admin.ask('GET', '/enrolment')).body.state === 'running');
  run.rig.show('p01-enrol');
  await seesText(page, /enrolled already[^]*p01/i, 30000);
  run.rig.show();
  expect(!(await run.people()).some((person) => person.name === 'impostor'), 'nobody was expected to be enrolled twice');
}

// An enrolment ends when nobody watches it any more: the door must not stay unwatched.
async function abandoned(run) {
  const page = await run.browser.open(); // a session of its own: no other window of it watches the enrolment
  await logIn(page, 'role-enroller', run.password);
  await openForm(page, 'nobody');
  await choose(page, 'checkbox', CONSENT, true);
  await press(page, 'button', BEGIN);
  await eventually('the door is not watched', async () => (await run.status()).mode === 'enroll');
  await page.close();
  await eventually('the door is watched again', async () => (await run.status()).mode === 'watch', 60000);
}

export async function enrol(run) {
  await step('nobody is enrolled without consent', () => withoutConsent(run));
  await step('p01 is enrolled, with a relief and a record of the consent', () => frontally(run));
  await step('ada is enrolled in five steps as the page asks', () => inPoses(run));
  await step('a face that is enrolled already is refused, with its name', () => twice(run));
  await step('an enrolment whose page is closed ends by itself', () => abandoned(run));
}
