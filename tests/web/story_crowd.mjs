// Ten thousand people: the page lists and searches them. Durations are taken in the page, from the act to the picture with its result.
import { expect, expectEqual, median, need, say, step } from './check.mjs';
import { logIn } from './story_login.mjs';
import { seesText } from './browser.mjs';

const PEOPLE = 10000;
const AIM_MS = 200;
const TIMES = 5;

// The milliseconds from an act until the page shows what `done` waits for, which is asked for in every picture that the browser draws.
function timed(page, act, done, value) {
  return page.evaluate(async (actText, doneText, argument) => {
    const [perform, isDone] = [actText, doneText].map((text) => window.webCheckTimed[text]);
    const start = performance.now();
    perform(argument);
    while (!isDone(argument)) {
      if (performance.now() - start > 20000) {
        return NaN;
      }
      await new Promise((resolve) => requestAnimationFrame(resolve));
    }
    return performance.now() - start;
  }, act, done, value);
}

// The acts and the conditions, in the page.
function prepare() {
  const rows = () => [...document.querySelectorAll('main tbody tr[aria-rowindex]')];
  const named = (name) => rows().some((row) => row.cells[0].innerText.trim() === name);
  const search = () => document.querySelector('main input[type=search]');
  window.webCheckTimed = {
    leave: () => document.querySelector('nav a[href*=door]').click(),
    hasLeft: () => !search(),
    come: () => document.querySelector('nav a[href*=people]').click(),
    lists: () => search() && rows().length > 10 && document.querySelector('main').innerText.replace(/[^0-9A-Za-z]/g, '').includes('10000'),
    search: (text) => {
      search().value = text;
      search().dispatchEvent(new Event('input', { bubbles: true }));
    },
    finds: (text) => named(text) && rows().length < 10,
    clear: () => window.webCheckTimed.search(''),
    showsAll: () => rows().length > 10,
  };
}

function judge(what, times) {
  expect(times.every(Number.isFinite), `${what}: the result was expected within 20 s`);
  say(`         ${what}: ${median(times).toFixed(0)} ms (median of ${times.length}: ${times.map((ms) => ms.toFixed(0)).join(', ')}; the aim is ${AIM_MS} ms)`);
  expect(median(times) <= 10 * AIM_MS, `${what}: at most ${10 * AIM_MS} ms were expected even on a busy machine`);
}

async function listsThem(run) {
  const times = [];
  for (let i = 0; i < TIMES; i++) {
    await timed(run.crowdPage, 'leave', 'hasLeft');
    times.push(await timed(run.crowdPage, 'come', 'lists'));
  }
  judge(`listing ${PEOPLE} people`, times);
}

async function findsThem(run) {
  const times = [];
  for (const number of [4321, 1234, 5555, 8008, 9999]) {
    times.push(await timed(run.crowdPage, 'search', 'finds', `person ${number}`));
    await timed(run.crowdPage, 'clear', 'showsAll');
  }
  judge(`searching in ${PEOPLE} people`, times);
}

async function scrolls(run) {
  const name = await run.crowdPage.evaluate(async () => {
    document.querySelector('main .rows').scrollTo(0, 1e9);
    await new Promise((resolve) => setTimeout(resolve, 500));
    const rows = [...document.querySelectorAll('main tbody tr[aria-rowindex]')];
    if (rows.length > 200) {
      return `more than 200 rows are in the page: ${rows.length}`;
    }
    return rows.map((row) => row.cells[0].innerText.trim()).join('|');
  });
  expect(name.includes('person 9999'), `the last one of ${PEOPLE} people was expected after scrolling to the end: ...${name.slice(-80)}`);
}

export async function crowd(run) {
  await need(`the daemon starts with ${PEOPLE} people while the web server runs`, async () => {
    await run.rig.startCrowd(PEOPLE);
    const answer = await run.admin.ask('GET', '/people');
    expectEqual(answer.body.people?.length, PEOPLE, 'the people that GET /people lists');
    const page = await run.browser.open({ path: '/' });
    await logIn(page, run.account, run.password);
    await page.evaluate(prepare);
    await seesText(page, /person|people/i);
    run.crowdPage = page;
  });
  await step(`${PEOPLE} people are listed in ${AIM_MS} ms`, () => listsThem(run));
  await step(`a person among ${PEOPLE} is found in ${AIM_MS} ms`, () => findsThem(run));
  await step(`the last of ${PEOPLE} people can be reached by scrolling`, () => scrolls(run));
  await run.crowdPage?.close();
}
