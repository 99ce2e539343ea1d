// Chromium, and pages that are watched: violations of the content security policy, requests to other hosts, and errors of scripts are
// collected during the whole run.
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import puppeteer from 'puppeteer-core';
import { eventually } from './check.mjs';

export const SIZES = [
  { name: 'phone', width: 390, height: 844 },
  { name: 'desk', width: 1280, height: 800 },
];

export class Browser {
  constructor({ base, keyHash, scratch }) {
    Object.assign(this, { base, keyHash, scratch });
    this.violations = []; // of the content security policy
    this.foreign = []; // requests to other hosts
    this.faults = []; // exceptions of scripts
    this.messages = []; // the console, for a failed step
    this.requests = 0;
    this.pages = new Set();
  }

  async start(language = 'en') {
    this.profile = join(this.scratch, `profile-${language}-${Date.now()}`);
    mkdirSync(this.profile);
    this.chromium = await puppeteer.launch({
      executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
      headless: true,
      userDataDir: this.profile,
      env: { ...process.env, LANGUAGE: language, LANG: language === 'en' ? 'en_US.UTF-8' : `${language}.UTF-8` },
      args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
        '--disable-component-update', '--disable-sync', '--disable-dev-shm-usage', `--accept-lang=${language}`, `--lang=${language}`,
        `--ignore-certificate-errors-spki-list=${this.keyHash}`, '--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1'],
    });
    return this;
  }

  async stop() {
    await this.chromium?.close();
  }

  // A window in a profile of its own, so that it has no cookie of another page, or in `context`. A tab hides the one before it; a hidden
  // page draws nothing and cannot be clicked.
  async open({ path = '/', size = SIZES[1], theme = 'light', context, tab = false } = {}) {
    const own = context ?? (await this.chromium.createBrowserContext());
    const page = await own.newPage(tab ? { type: 'tab' } : { type: 'window' });
    page.context = own;
    await this.watch(page);
    await page.setViewport({ width: size.width, height: size.height });
    await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: theme }, { name: 'prefers-reduced-motion', value: 'reduce' }]);
    await page.goto(this.base + path, { waitUntil: 'load' });
    return page;
  }

  async closeAllBut(...kept) {
    await Promise.all([...this.pages].filter((page) => !kept.includes(page)).map((page) => page.close()));
  }

  async watch(page) {
    this.pages.add(page);
    page.on('close', () => this.pages.delete(page));
    page.on('console', (message) => this.note(`console ${message.type()}: ${message.text()}`));
    page.on('pageerror', (fault) => {
      this.faults.push(`${page.url()}: ${fault.message}`);
      this.note(`exception: ${fault.stack ?? fault.message}`);
    });
    page.on('request', (request) => {
      this.requests++;
      const url = new URL(request.url());
      if (!['data:', 'blob:'].includes(url.protocol) && url.origin !== this.base) {
        this.foreign.push(request.url());
      }
    });
    page.on('requestfailed', (request) => this.note(`request failed: ${request.method()} ${request.url()} ${request.failure()?.errorText}`));
    page.on('response', (answer) => {
      if (answer.status() >= 400) {
        this.note(`answer ${answer.status()}: ${answer.request().method()} ${answer.url()}`);
      }
    });
    await page.exposeFunction('webCheckViolation', (text) => this.violations.push(text));
    await page.evaluateOnNewDocument(() => {
      // An object of the window: the listener has to be there before the first script of the page.
      window.addEventListener('securitypolicyviolation', (event) => {
        window.webCheckViolation(`${event.documentURI}: ${event.violatedDirective} ${event.blockedURI} ${event.sourceFile ?? ''}:${event.lineNumber}`);
      });
    });
  }

  note(text) {
    this.messages.push(`${new Date().toISOString()} ${text}`);
    if (/Content Security Policy/i.test(text)) {
      this.violations.push(text);
    }
  }

  // After a failed step: a picture of every page, its address and text, and the console.
  async writeHelp(path) {
    let number = 0;
    for (const page of this.pages) {
      await page.screenshot({ path: `${path}-${number}.png` });
      const text = await page.evaluate(() => document.body.innerText);
      writeFileSync(`${path}-${number}.txt`, `${page.url()}\n${text}\n`);
      number++;
    }
    writeFileSync(`${path}-console.txt`, this.messages.slice(-200).join('\n'));
  }
}

// ---- what the pages have in common ----

// The element of an ARIA role and name, as a screen reader finds it. name: a text, or a regular expression
export async function find(page, role, name, limitMs = 10000) {
  return eventually(`an element ${role} "${name}" on ${page.url()}`, async () => {
    for (const handle of await page.$$(`::-p-aria([role="${role}"])`)) {
      const box = await handle.boundingBox();
      if (box && (name === undefined || matches(await nameOf(page, handle), name))) {
        return handle;
      }
    }
    return null;
  }, limitMs);
}

const matches = (text, name) => (name instanceof RegExp ? name.test(text) : text === name);

// The accessible name of an element, as the browser computes it.
export async function nameOf(page, handle) {
  const node = await page.accessibility.snapshot({ root: handle, interestingOnly: false });
  return node?.name?.trim() ?? '';
}

export async function press(page, role, name) {
  const handle = await find(page, role, name);
  await handle.evaluate((element) => element.scrollIntoView({ block: 'center' }));
  await handle.click();
}

export async function fill(page, role, name, text) {
  const handle = await find(page, role, name);
  await type(handle, text);
}

// Types a text into a field in the place of what is there.
export async function type(handle, text) {
  await handle.evaluate((element) => {
    element.focus();
    element.select?.();
  });
  await handle.press('Backspace');
  await handle.type(text);
}

export const textOf = (page) => page.evaluate(() => document.body.innerText);

export async function seesText(page, pattern, limitMs = 10000) {
  return eventually(`the text ${pattern} on ${page.url()}`, async () => {
    const text = await textOf(page);
    return pattern instanceof RegExp ? pattern.test(text) : text.includes(pattern);
  }, limitMs);
}

// Values that a script has shown by mistake instead of a text.
export async function slips(page) {
  const values = new Set(await page.$$eval('code', (all) => all.map((one) => one.innerText.trim()))); // of the daemon, as they are
  const lines = (await textOf(page)).split('\n').map((line) => line.trim()).filter((line) => !values.has(line));
  return lines.filter((line) => /\[object |\bundefined\b|\bNaN\b|Invalid Date|\{\w+\}/.test(line) || /^(false|true|null)$/.test(line));
}

// Waits for an alert, which a screen reader reads aloud, with a text that matches.
export async function seesAlert(page, pattern, limitMs = 10000) {
  return eventually(`an alert ${pattern} on ${page.url()}`, async () => {
    const texts = await alerts(page);
    return texts.find((text) => pattern.test(text));
  }, limitMs);
}

// The texts of the alerts that are seen.
export const alerts = (page) => page.evaluate(() => [...document.querySelectorAll('[role=alert]')]
  .filter((element) => element.getClientRects().length).map((element) => element.innerText.trim()).filter(Boolean));

// Sets a field whose text cannot simply be typed, such as a time.
export async function set(handle, value) {
  await handle.evaluate((element, text) => {
    element.value = text;
    element.dispatchEvent(new Event('input', { bubbles: true }));
    element.dispatchEvent(new Event('change', { bubbles: true }));
  }, value);
}

// The accessible roles and names on a page, for a person who writes a step.
export async function outline(page) {
  return page.accessibility.snapshot({ interestingOnly: true });
}

// Fills every visible field whose name matches: [[name, text], ...]. Each name has to match a field.
export async function fillAll(page, fields) {
  for (const [name, text] of fields) {
    await find(page, 'textbox', name);
    for (const handle of await page.$$('::-p-aria([role="textbox"])')) {
      if ((await handle.boundingBox()) && matches(await nameOf(page, handle), name)) {
        await type(handle, text);
      }
    }
  }
}
