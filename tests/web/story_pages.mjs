// Every page in both themes and two sizes: pictures, the rules of accessibility, the keyboard alone, and languages.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { eventually, expect, expectEqual, pause, step } from './check.mjs';
import { Browser, SIZES, find, seesText, slips } from './browser.mjs';
import { colours } from './picture.mjs';
import { logIn } from './story_login.mjs';

const THEMES = ['light', 'dark'];
const axe = readFileSync(new URL('node_modules/axe-core/axe.min.js', import.meta.url), 'utf8');

// The rules of WCAG 2.2 A and AA. Returns the serious and critical violations.
async function violations(page) {
  await page.evaluate(axe);
  const found = await page.evaluate(async () => {
    const rules = { runOnly: { type: 'tag', values: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'] } };
    const result = await window.axe.run(document, rules);
    return result.violations.map((one) => ({ id: one.id, impact: one.impact, where: one.nodes.map((node) => `${node.target} (${node.failureSummary.split('\n').at(-1).trim()})`) }));
  });
  return found.filter((one) => ['serious', 'critical'].includes(one.impact));
}

async function examine(run, page, name, theme, size) {
  await page.setViewport({ width: size.width, height: size.height });
  await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: theme }, { name: 'prefers-reduced-motion', value: 'reduce' }]);
  await pause(300);
  const picture = await page.screenshot({ path: join(run.out, `${name}-${theme}-${size.name}.png`) });
  expect(colours(picture) > 8, `${name}, ${theme}, ${size.name}: a picture with more than 8 colours was expected`);
  expectEqual((await slips(page)).join(), '', `values on the page ${name} that are no text`);
  const wide = await page.evaluate(() => document.scrollingElement.scrollWidth - window.innerWidth);
  expect(wide <= 1, `${name}, ${size.name}: the page was expected not to be wider than the window, and is by ${wide} px`);
  const found = await violations(page);
  expect(found.length === 0, `${name}, ${theme}, ${size.name}: no serious violation was expected: ${JSON.stringify(found)}`);
}

// Examines what a page shows now in both themes and sizes. All faults are collected, so that one run tells all of them.
export async function examineAll(run, page, name) {
  const faults = [];
  for (const theme of THEMES) {
    for (const size of SIZES) {
      try {
        await examine(run, page, name, theme, size);
      } catch (fault) {
        faults.push(fault.message);
      }
    }
  }
  await page.setViewport({ width: SIZES[1].width, height: SIZES[1].height });
  expect(faults.length === 0, faults.join('; '));
}

// The links of the navigation: [{name, href}]
export function pagesOf(page) {
  return page.evaluate(() => [...document.querySelectorAll('nav a[href]')].map((link) => ({ name: link.innerText.trim(), href: link.href })));
}

export async function everyPage(run) {
  const page = run.first;
  const pages = await pagesOf(page);
  expect(pages.length >= 6, `at least six pages were expected in the navigation: ${JSON.stringify(pages)}`);
  for (const { name, href } of pages) {
    await step(`the page ${name}: pictures, and the rules of accessibility in both themes and sizes`, async () => {
      await page.goto(href);
      await find(page, 'heading', undefined);
      await pause(700); // a state that comes with the first event
      await examineAll(run, page, name.toLowerCase().replace(/[^a-z]+/g, '-'));
    });
  }
}

// Presses the tabulator until the element that has the focus has this role and name.
export async function tabTo(page, test, what) {
  for (let i = 0; i < 80; i++) {
    await page.keyboard.press('Tab');
    const found = await page.evaluate((text) => {
      const element = document.activeElement;
      const outline = getComputedStyle(element);
      const words = `${element.tagName} ${element.type ?? ''} ${element.getAttribute('aria-label') ?? ''} ${element.innerText ?? ''} ${element.labels?.[0]?.innerText ?? ''}`;
      return { hit: new RegExp(text, 'i').test(words), words, seen: outline.outlineStyle !== 'none' || outline.boxShadow !== 'none' };
    }, test.source);
    if (found.hit) {
      expect(found.seen, `the focus on ${what} was expected to be visible`);
      return;
    }
  }
  throw new Error(`${what} was expected to be reached by 80 times Tab`);
}

async function keyboardAlone(run) {
  const page = await run.browser.open();
  await find(page, 'button', /^log in$/i, 20000);
  await tabTo(page, /^INPUT text/, 'the account');
  await page.keyboard.type(run.account);
  await tabTo(page, /^INPUT password/, 'the password');
  await page.keyboard.type(run.password);
  await page.keyboard.press('Enter');
  await find(page, 'navigation', undefined, 20000);
  await tabTo(page, /^A.*People/, 'the link People');
  await page.keyboard.press('Enter');
  await eventually('the page People', () => page.evaluate(() => /people/i.test(document.querySelector('main h1')?.innerText)));
  await tabTo(page, /^BUTTON.*Ada Lovelace/, 'the button of a person');
  await page.keyboard.press('Enter');
  await find(page, 'dialog', 'Ada Lovelace');
  const inside = await page.evaluate(() => Boolean(document.activeElement.closest('dialog, [role=dialog]')));
  expect(inside, 'the focus was expected to be inside the dialog');
  await page.keyboard.press('Escape');
  await eventually('the dialog closes with Escape', () => page.evaluate(() => !document.querySelector('dialog[open]')));
  const back = await page.evaluate(() => document.activeElement.innerText);
  expectEqual(back, 'Ada Lovelace', 'what has the focus after the dialog');
  await page.close();
}

// Texts of several words that the English pages have, too, are not translated. Names of people are the same in all languages; what the
// daemon says in English is marked as English.
export async function language(run, tag, direction) {
  const browser = await new Browser({ base: run.rig.base, keyHash: run.rig.keyHash(), scratch: run.rig.scratch }).start(tag);
  run.browsers.push(browser);
  const texts = (page) => page.evaluate(() => {
    const found = new Set();
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
      const text = node.textContent.trim();
      if (node.parentElement.getClientRects().length && /[A-Za-z]{3} [A-Za-z]{2}/.test(text) && !node.parentElement.closest('body [lang=en], bdi, code, option')) {
        found.add(text);
      }
    }
    return [...found];
  });
  try {
    const page = await browser.open();
    await eventually(`the language ${tag}`, () => page.evaluate((lang) => document.documentElement.lang.startsWith(lang), tag));
    expectEqual(await page.evaluate(() => document.documentElement.dir || 'ltr'), direction, `the direction of ${tag}`);
    await page.waitForSelector('input[type=password]');
    expectEqual(await page.evaluate(() => getComputedStyle(document.querySelector('main')).direction), direction, `the direction of main in ${tag}`);
    await page.type('input[autocomplete=username]', run.account);
    await page.type('input[type=password]', run.password);
    await page.keyboard.press('Enter');
    await page.waitForSelector('nav a[href]');
    const missing = [];
    for (const { name, href } of await pagesOf(page)) {
      await page.goto(href);
      await page.waitForSelector('main h1');
      await pause(600);
      await page.screenshot({ path: join(run.out, `language-${tag}-${new URL(href).hash.replace(/\W/g, '') || new URL(href).pathname.replace(/\W/g, '') || 'start'}.png`) });
      const wide = await page.evaluate(() => document.scrollingElement.scrollWidth - window.innerWidth);
      expect(wide <= 1, `${tag}, ${name}: the page was expected not to be wider than the window, and is by ${wide} px`);
      const english = new Set(run.englishTexts.flat());
      missing.push(...(await texts(page)).filter((text) => english.has(text)));
    }
    expect(missing.length === 0, `${tag}: no English text was expected: ${JSON.stringify([...new Set(missing)])}`);
  } finally {
    await browser.stop();
  }
}

export async function collectEnglish(run) {
  run.englishTexts = [];
  const page = run.first;
  for (const { href } of await pagesOf(page)) {
    await page.goto(href);
    await find(page, 'heading', undefined);
    await pause(600);
    run.englishTexts.push(await page.evaluate(() => document.body.innerText.split('\n').map((line) => line.trim()).filter((line) => /[A-Za-z]{3}/.test(line))));
  }
  expect(run.englishTexts.flat().length > 50, 'more than 50 texts were expected on all pages');
}

export async function pages(run) {
  await everyPage(run);
  await step('the keyboard alone: log in, reach People, open and close a dialog', () => keyboardAlone(run));
  await step('the English texts of all pages are collected', () => collectEnglish(run));
  await step('German: every text is translated', () => language(run, 'de', 'ltr'));
  await step('Arabic: from right to left, every text is translated', () => language(run, 'ar', 'rtl'));
  await seesText(run.first, /./);
}
