# expect: 10:11: too much to read once aliases are expanded; at most 50000 values are read
meta:
  id: bad
  endian: be
types:
  t0: &t
    -requirement: WIRE-DATA
    seq: &s
      - {id: f0, size-eos: true, type: {switch-on: 1, cases: &c {
          0: t1, 1: t1, 2: t1, 3: t1, 4: t1, 5: t1, 6: t1, 7: t1, 8: t1, 9: t1, 
          10: t1, 11: t1, 12: t1, 13: t1, 14: t1, 15: t1, 16: t1, 17: t1, 18: t1, 19: t1, 
          20: t1, 21: t1, 22: t1, 23: t1, 24: t1, 25: t1, 26: t1, 27: t1, 28: t1, 29: t1, 
          30: t1, 31: t1, 32: t1, 33: t1, 34: t1, 35: t1, 36: t1, 37: t1, 38: t1, 39: t1, 
          40: t1, 41: t1, 42: t1, 43: t1, 44: t1, 45: t1, 46: t1, 47: t1, 48: t1, 49: t1, 
          50: t1, 51: t1, 52: t1, 53: t1, 54: t1, 55: t1, 56: t1, 57: t1, 58: t1, 59: t1}}}
      - {id: f1, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f2, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f3, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f4, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f5, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f6, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f7, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f8, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f9, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f10, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f11, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f12, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f13, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f14, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f15, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f16, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f17, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f18, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f19, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f20, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f21, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f22, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f23, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f24, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f25, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f26, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f27, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f28, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f29, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f30, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f31, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f32, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f33, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f34, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f35, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f36, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f37, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f38, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f39, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f40, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f41, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f42, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f43, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f44, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f45, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f46, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f47, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f48, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f49, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f50, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f51, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f52, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f53, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f54, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f55, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f56, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f57, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f58, size-eos: true, type: {switch-on: 1, cases: *c}}
      - {id: f59, size-eos: true, type: {switch-on: 1, cases: *c}}
  t1: *t
  t2: *t
  t3: *t
  t4: *t
  t5: *t
  t6: *t
  t7: *t
  t8: *t
  t9: *t
  t10: *t
  t11: *t
  t12: *t
  t13: *t
  t14: *t
  t15: *t
  t16: *t
  t17: *t
  t18: *t
  t19: *t
  t20: *t
  t21: *t
  t22: *t
  t23: *t
  t24: *t
  t25: *t
  t26: *t
  t27: *t
  t28: *t
  t29: *t
  t30: *t
  t31: *t
  t32: *t
  t33: *t
  t34: *t
  t35: *t
  t36: *t
  t37: *t
  t38: *t
  t39: *t
  t40: *t
  t41: *t
  t42: *t
  t43: *t
  t44: *t
  t45: *t
  t46: *t
  t47: *t
  t48: *t
  t49: *t
  t50: *t
  t51: *t
  t52: *t
  t53: *t
  t54: *t
  t55: *t
  t56: *t
  t57: *t
  t58: *t
  t59: *t
  t60: *t
  t61: *t
  t62: *t
  t63: *t
  t64: *t
  t65: *t
  t66: *t
  t67: *t
  t68: *t
  t69: *t
