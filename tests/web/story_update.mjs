// An administrator brings updates by the page Update. play_rauc stands for RAUC; what the units of the image do when a bundle or a wish for a
// restart comes, this file does, with the programs of the image.
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { eventually, expect, expectEqual, pause, step } from './check.mjs';
import { alerts, find, press, seesAlert, seesText, textOf } from './browser.mjs';
import { start, stop } from './rig.mjs';
import { goTo } from './story_login.mjs';
import { examineAll } from './story_pages.mjs';

const NOT_NEWER = 'Pre-install handler error: Child process exited with code 3';
const folder = (run) => join(run.rig.scratch, 'root/var/lib/isotherm-update');
const pageFile = (run, name) => join(folder(run), 'page', name);

async function raucIs(run, ...words) {
  await stop(run.rauc);
  const log = run.rig.log('play_rauc');
  rmSync(log, { force: true });
  run.rauc = start(join(run.rig.build, 'tests/enroll/play_rauc'), [run.rig.address, ...words], log);
  await eventually('the stand-in for RAUC', () => existsSync(log) && readFileSync(log, 'utf8').startsWith('r'));
}

// A program of the image, with `isotherm` and `busctl` on the bus of the run.
function program(run, name, ...words) {
  const bin = join(run.rig.scratch, 'bin');
  if (!existsSync(bin)) {
    mkdirSync(bin);
    const wrap = (tool, text) => writeFileSync(join(bin, tool), `#!/bin/sh\n${text}\n`, { mode: 0o755 });
    wrap('isotherm', `exec "${join(run.rig.build, 'enroll/isotherm')}" --bus "${run.rig.address}" "$@"`);
    wrap('busctl', `exec /usr/bin/busctl --address="${run.rig.address}" "$@"`);
    wrap('systemctl', `echo "$*" >>"${join(run.rig.scratch, 'systemctl.asked')}"`);
  }
  return start(join(run.rig.source, 'board/image/programs', name), words, run.rig.log(name),
    { PATH: `${bin}:${process.env.PATH}`, ISOTHERM_ROOT: join(run.rig.scratch, 'root') });
}

// What isotherm-update@page.path and its service do.
async function install(run) {
  await eventually('a bundle that is handed over', () => existsSync(pageFile(run, 'bundle.raucb')));
  return program(run, 'install-update', 'page', pageFile(run, 'bundle.raucb'));
}

async function choose(run, page, name, contents) {
  const path = join(run.rig.scratch, name);
  writeFileSync(path, contents);
  const [chooser] = await Promise.all([page.waitForFileChooser(), press(page, 'button', /^choose an update…$/i)]);
  await chooser.accept([path]);
}

async function noImage(run) {
  const page = run.first;
  await goTo(page, /^update$/i);
  await seesText(page, /is no image of the appliance/i);
  await examineAll(run, page, 'update-none');
  const answer = await run.admin.ask('POST', '/update', 'bundle', { 'content-type': 'application/octet-stream' });
  expectEqual(`${answer.status} ${answer.code}`, '409 no-image', 'a bundle for a machine that is no image');
}

async function refused(run) {
  const page = run.first;
  mkdirSync(join(folder(run), 'page'), { recursive: true });
  await raucIs(run, '--error', NOT_NEWER);
  await goTo(page, /^update$/i);
  await seesText(page, /in use/i);
  await choose(run, page, 'isotherm-1.raucb', 'an old update');
  await (await install(run)).ended;
  await seesText(page, /not installed.*it is not newer than the version that runs/is);
  await examineAll(run, page, 'update-refused');
  await choose(run, page, 'empty.raucb', '');
  await seesAlert(page, /has not arrived whole/i);
  expect(!existsSync(pageFile(run, 'bundle.part')) && !existsSync(pageFile(run, 'bundle.raucb')), 'nothing was expected to stay');
}

async function installed(run) {
  const page = run.first;
  const hold = join(run.rig.scratch, 'hold');
  const bundle = Buffer.alloc(20 << 20, 'a bundle of many bytes. ');
  writeFileSync(hold, '');
  await raucIs(run, '--hold', hold);
  await choose(run, page, 'isotherm-2.raucb', bundle);
  await eventually('the bundle is handed over', () => existsSync(pageFile(run, 'bundle.raucb')), 60000);
  expect(readFileSync(pageFile(run, 'bundle.raucb')).equals(bundle), 'the bundle was expected to arrive as it is');
  const unit = await install(run);
  await seesText(page, /is being checked and installed.*40\s?%/is, 20000);
  await examineAll(run, page, 'update-installing');
  const second = await run.admin.ask('POST', '/update', 'bundle', { 'content-type': 'application/octet-stream' });
  expectEqual(`${second.status} ${second.code}`, '409 update-running', 'a second bundle meanwhile');
  rmSync(hold);
  expectEqual(await unit.ended, 0, 'the exit code of install-update');
  await seesText(page, /version 2\.0\.0 is installed and starts at the next restart/i, 20000);
  await examineAll(run, page, 'update-installed');
  const acts = (await run.records()).filter((record) => record.event === 'act').map((record) => record.note);
  expect(acts.some((note) => note.startsWith(`update, asked by ${run.account} of`)), `the update of ${run.account} was expected on record: ${acts.slice(-5).join('; ')}`);
  expect(acts.some((note) => note.startsWith('update-installed, asked by page of')), 'the end of the update was expected on record');
}

async function restarts(run) {
  const page = run.first;
  await press(page, 'button', /^restart…$/i);
  await find(page, 'dialog', /restart now/i);
  await examineAll(run, page, 'update-restart');
  await press(page, 'button', /^restart$/i);
  await eventually('the wish for a restart', () => existsSync(pageFile(run, 'restart')));
  expectEqual(await program(run, 'restart-into-update', 'page').ended, 0, 'the exit code of restart-into-update');
  expectEqual(readFileSync(join(run.rig.scratch, 'systemctl.asked'), 'utf8').trim(), 'reboot', 'what systemd is asked');
  expect(!existsSync(pageFile(run, 'restart')), 'the wish was expected to be removed');
  expectEqual((await alerts(page)).join(''), '', 'faults on the page');
}

// The page is left while a file is sent: nothing of it stays.
async function leftAlone(run) {
  const page = run.first;
  const session = await page.createCDPSession();
  await session.send('Network.enable');
  await session.send('Network.emulateNetworkConditions', { offline: false, latency: 0, downloadThroughput: -1, uploadThroughput: 1 << 20 });
  await choose(run, page, 'isotherm-3.raucb', Buffer.alloc(60 << 20, 'x'));
  await eventually('a bundle that comes', () => existsSync(pageFile(run, 'bundle.part')), 30000);
  await goTo(page, /^door$/i);
  await eventually('nothing stays', () => !existsSync(pageFile(run, 'bundle.part')), 30000);
  await session.send('Network.emulateNetworkConditions', { offline: false, latency: 0, downloadThroughput: -1, uploadThroughput: -1 });
  await session.detach();
  await pause(500);
  expect(!/sending/i.test(await textOf(page)), 'no sending was expected on another page');
  await stop(run.rauc);
}

export async function updates(run) {
  await step('a machine that is no image takes no update', () => noImage(run));
  await step('an update that is not newer is refused in plain words', () => refused(run));
  await step('an update is brought, installed and put on record', () => installed(run));
  await step('the appliance restarts into the update', () => restarts(run));
  await step('an update whose page is left leaves nothing', () => leftAlone(run));
}
