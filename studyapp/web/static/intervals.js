// Parts of a video, each from and to in seconds.

export function merged(intervals) {
  const union = [];
  for (const [from, to] of [...intervals].sort((a, b) => a[0] - b[0])) {
    const last = union[union.length - 1];
    if (last && from <= last[1]) last[1] = Math.max(last[1], to);
    else union.push([from, to]);
  }
  return union;
}

export function length(intervals) {
  return intervals.reduce((sum, [from, to]) => sum + to - from, 0);
}
