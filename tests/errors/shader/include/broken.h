float broken(float x) {
  return x * ;
}
